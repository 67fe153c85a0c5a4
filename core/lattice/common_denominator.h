// The fractions that doubles approximate.
#ifndef LATVOX_CORE_LATTICE_COMMON_DENOMINATOR_H_
#define LATVOX_CORE_LATTICE_COMMON_DENOMINATOR_H_

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>

namespace latvox {

// Returns the smallest D up to 1024 for which all ratios are multiples of 1/D, within a tolerance.
inline std::optional<int64_t> CommonDenominator(std::span<const double> ratios, double tolerance) {
  constexpr int64_t kMost = 1024;
  for (int64_t d = 1; d <= kMost; ++d) {
    const auto is_multiple = [&](double ratio) {
      const double multiple = ratio * static_cast<double>(d);
      return std::abs(multiple - std::nearbyint(multiple)) <= tolerance * static_cast<double>(d);
    };
    if (std::all_of(ratios.begin(), ratios.end(), is_multiple)) return d;
  }
  return std::nullopt;
}

}  // namespace latvox

#endif  // LATVOX_CORE_LATTICE_COMMON_DENOMINATOR_H_
