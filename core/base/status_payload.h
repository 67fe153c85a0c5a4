// The field, the value and the limit of an error, besides its message, for programs to read.
#ifndef LATVOX_CORE_BASE_STATUS_PAYLOAD_H_
#define LATVOX_CORE_BASE_STATUS_PAYLOAD_H_

#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/cord.h"
#include "absl/strings/str_format.h"

namespace latvox {

// Payloads of a status.
inline constexpr char kRefusedField[] = "latvox/field", kRefusedValue[] = "latvox/value",
                      kRefusedLimit[] = "latvox/limit", kRefusedOther[] = "latvox/other";

inline absl::Status WithValue(absl::Status status, const std::string& value, const std::string& limit = "") {
  status.SetPayload(kRefusedValue, absl::Cord(value));
  if (!limit.empty()) status.SetPayload(kRefusedLimit, absl::Cord(limit));
  return status;
}

// For a message that does not begin with the field and a colon.
inline absl::Status WithField(absl::Status status, const std::string& field, const std::string& value,
                              const std::string& limit = "") {
  status.SetPayload(kRefusedField, absl::Cord(field));
  return value.empty() ? status : WithValue(std::move(status), value, limit);
}

inline absl::Status WithValue(absl::Status status, double value, double limit) {
  return WithValue(std::move(status), absl::StrFormat("%.15g", value), absl::StrFormat("%.15g", limit));
}

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_STATUS_PAYLOAD_H_
