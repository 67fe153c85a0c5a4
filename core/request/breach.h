// A rule that a request breaks.
#ifndef LATVOX_CORE_REQUEST_BREACH_H_
#define LATVOX_CORE_REQUEST_BREACH_H_

#include <optional>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "core/base/vec.h"

namespace latvox {

struct Breach {
  std::string field;    // path in the request: "shard.count"
  std::string message;  // names field, value and limit
  std::string value = "";
  std::string limit = "";
  std::string other = "";  // the field that excludes this one, if that is the breach
};

// INVALID_ARGUMENT with field, value, limit and other as payloads (core/base/status_payload.h).
absl::Status ToStatus(const Breach& breach);

// Breaches of rules that several fields share; nullopt: none.
std::optional<Breach> FindNotFinite(std::string_view field, const Vec3d& v);
std::optional<Breach> FindNotPositive(std::string_view field, double x);
std::optional<Breach> FindNegative(std::string_view field, double x);  // or not finite

}  // namespace latvox

#endif  // LATVOX_CORE_REQUEST_BREACH_H_
