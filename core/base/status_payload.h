// The value that an error is about, and the limit that it was held against, beside the message: for who tells them to
// programs.
#ifndef LATVOX_CORE_BASE_STATUS_PAYLOAD_H_
#define LATVOX_CORE_BASE_STATUS_PAYLOAD_H_

#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/cord.h"
#include "absl/strings/str_format.h"

namespace latvox {

inline constexpr char kRefusedValue[] = "latvox/value", kRefusedLimit[] = "latvox/limit";  // payloads of a status

inline absl::Status WithValue(absl::Status status, const std::string& value, const std::string& limit = "") {
  status.SetPayload(kRefusedValue, absl::Cord(value));
  if (!limit.empty()) status.SetPayload(kRefusedLimit, absl::Cord(limit));
  return status;
}

inline absl::Status WithValue(absl::Status status, double value, double limit) {
  return WithValue(std::move(status), absl::StrFormat("%.15g", value), absl::StrFormat("%.15g", limit));
}

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_STATUS_PAYLOAD_H_
