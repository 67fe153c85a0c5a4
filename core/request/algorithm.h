// The ways to voxelize, by name.
#ifndef LATVOX_CORE_REQUEST_ALGORITHM_H_
#define LATVOX_CORE_REQUEST_ALGORITHM_H_

#include <array>
#include <optional>
#include <string_view>
#include <utility>

namespace latvox {

// The crossing rule (core/digitize), or one of the thesis's own algorithms (core/thesis) for comparison.
enum class Algorithm { kExact, kBruteForce, kIncremental, kOptimizedIncremental };

inline constexpr std::array<std::pair<Algorithm, std::string_view>, 4> kAlgorithms{
    {{Algorithm::kExact, "exact"},
     {Algorithm::kBruteForce, "brute-force"},
     {Algorithm::kIncremental, "incremental"},
     {Algorithm::kOptimizedIncremental, "optimized-incremental"}}};

constexpr std::string_view NameOf(Algorithm algorithm) {
  for (const auto& [value, name] : kAlgorithms) {
    if (value == algorithm) return name;
  }
  return "";
}

// The voxels that the exact algorithm finds: a separating set, or all voxels whose closed Voronoi cell meets the
// surface (core/supercover/supercover.h). The second set contains every separating set of the first kind, thinned or
// not, and separates for every k. Let the surface meet a lattice link z -> z+q. The cells of z and z+q are convex and
// meet in the middle of the link, so they cover it. So the surface meets one of the two cells.
enum class Cover { kSeparating, kSupercover };

constexpr std::string_view NameOf(Cover cover) { return cover == Cover::kSupercover ? "supercover" : "separating"; }

constexpr std::optional<Algorithm> AlgorithmNamed(std::string_view name) {
  for (const auto& [value, known] : kAlgorithms) {
    if (known == name) return value;
  }
  return std::nullopt;
}

}  // namespace latvox

#endif  // LATVOX_CORE_REQUEST_ALGORITHM_H_
