// The ways to voxelize, by name.
#ifndef LATVOX_CORE_VOXELIZER_ALGORITHM_H_
#define LATVOX_CORE_VOXELIZER_ALGORITHM_H_

#include <array>
#include <optional>
#include <string_view>
#include <utility>

namespace latvox {

// The crossing rule (core/digitize), or one of the thesis's own algorithms (core/thesis), to compare with.
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

constexpr std::optional<Algorithm> AlgorithmNamed(std::string_view name) {
  for (const auto& [value, known] : kAlgorithms) {
    if (known == name) return value;
  }
  return std::nullopt;
}

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_ALGORITHM_H_
