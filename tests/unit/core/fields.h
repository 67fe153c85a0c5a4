// The fields of a result, voxel by voxel.
#ifndef LATVOX_TESTS_UNIT_CORE_FIELDS_H_
#define LATVOX_TESTS_UNIT_CORE_FIELDS_H_

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <map>
#include <vector>

#include "core/brick/brick.h"
#include "core/request/fields.h"

namespace latvox {

// The bytes of each field of a voxel, in the order of the request.
using VoxelFields = std::vector<std::vector<std::byte>>;

template <class T, size_t N = 1>
std::array<T, N> NumbersOf(const std::vector<std::byte>& bytes) {
  std::array<T, N> numbers{};
  EXPECT_EQ(bytes.size(), sizeof(numbers));
  std::memcpy(numbers.data(), bytes.data(), std::min(bytes.size(), sizeof(numbers)));
  return numbers;
}

// Checks the lengths, too. neighbors: of a voxel, for fields of links; labels: of its fractions.
inline std::map<Vec3i, VoxelFields> FieldsByVoxel(const std::vector<TileBricks>& tiles, const FieldList& fields,
                                                  size_t neighbors = 0, size_t labels = 0) {
  std::map<Vec3i, VoxelFields> by_voxel;
  for (const TileBricks& tile : tiles) {
    EXPECT_EQ(tile.fields.size(), fields.size());
    EXPECT_TRUE(tile.squares.empty());
    size_t voxel = 0;
    for (const Brick& brick : tile.bricks) {
      for (int32_t bit = 0; bit < 512; ++bit) {
        if (!(brick.mask[static_cast<size_t>(bit >> 6)] >> (bit & 63) & 1)) continue;
        VoxelFields& of_voxel = by_voxel[brick.brick_ijk * kBrickSide + Vec3i{bit >> 6, bit >> 3 & 7, bit & 7}];
        for (size_t n = 0; n < fields.size(); ++n) {
          const auto bytes = static_cast<std::ptrdiff_t>(FactsOf(fields.view()[n]).bytes(neighbors, labels));
          const auto first = tile.fields[n].begin() + static_cast<std::ptrdiff_t>(voxel) * bytes;
          of_voxel.emplace_back(first, first + bytes);
        }
        ++voxel;
      }
    }
    EXPECT_EQ(voxel, tile.voxels);
    for (size_t n = 0; n < fields.size(); ++n) {
      EXPECT_EQ(tile.fields[n].size(), voxel * FactsOf(fields.view()[n]).bytes(neighbors, labels));
    }
  }
  return by_voxel;
}

// The distances of a result that carries them alone.
inline std::map<Vec3i, float> DistancesOf(const std::vector<TileBricks>& tiles) {
  std::map<Vec3i, float> distances;
  for (const auto& [ijk, fields] : FieldsByVoxel(tiles, {Field::kDistance})) {
    distances[ijk] = NumbersOf<float>(fields[0])[0];
  }
  return distances;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_FIELDS_H_
