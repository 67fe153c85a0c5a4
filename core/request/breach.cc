#include "core/request/breach.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/status_payload.h"

namespace latvox {

absl::Status ToStatus(const Breach& breach) {
  absl::Status status = WithField(absl::InvalidArgumentError(breach.message), breach.field, breach.value, breach.limit);
  if (!breach.other.empty()) status.SetPayload(kRefusedOther, absl::Cord(breach.other));
  return status;
}

std::optional<Breach> FindNotFinite(std::string_view field, const Vec3d& v) {
  for (size_t m = 0; m < 3; ++m) {
    if (std::isfinite(v[m])) continue;
    const std::string axis = absl::StrCat(std::string{field}, ".", std::string(1, "xyz"[m]));
    return Breach{axis, absl::StrCat(axis, " ", v[m], " is not finite"), absl::StrCat(v[m])};
  }
  return std::nullopt;
}

std::optional<Breach> FindNotPositive(std::string_view field, double x) {
  if (std::isfinite(x) && x > 0) return std::nullopt;
  const std::string name{field};
  return Breach{name, absl::StrCat(name, " ", x, " is not a finite number above 0"), absl::StrCat(x), "0"};
}

std::optional<Breach> FindNegative(std::string_view field, double x) {
  if (std::isfinite(x) && x >= 0) return std::nullopt;
  const std::string name{field};
  return Breach{name, absl::StrCat(name, " ", x, " is not a finite number from 0 on"), absl::StrCat(x), "0"};
}

}  // namespace latvox
