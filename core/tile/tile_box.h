// A dense set of voxels around one tile.
#ifndef LATVOX_CORE_TILE_TILE_BOX_H_
#define LATVOX_CORE_TILE_TILE_BOX_H_

#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

#include "core/tile/brick.h"

namespace latvox {

// One bit for each voxel of a cube of whole bricks. A voxel's index is brick<<9 | x<<6 | y<<3 | z, bricks being
// numbered like voxels, so that a brick's 512 bits are eight consecutive words in OpenVDB's order.
class TileBox {
 public:
  // The cube around `tile_ijk` (local) that has at least `margin` voxels on every side of the tile.
  TileBox(const Vec3i& tile_ijk, int32_t margin) {
    const int32_t margin_bricks = (margin + kBrickSide - 1) >> kBrickBits;
    for (size_t m = 0; m < 3; ++m) origin_[m] = tile_ijk[m] * kTileSide - margin_bricks * kBrickSide;
    side_bricks_ = static_cast<uint32_t>((kTileSide >> kBrickBits) + 2 * margin_bricks);
    words_.resize(size_t{8} * side_bricks_ * side_bricks_ * side_bricks_);
    for (uint32_t x = 0; x < side_bricks_ * kBrickSide; ++x) {
      const uint32_t brick = x >> kBrickBits << 9, within = x & (kBrickSide - 1);
      index_[0].push_back(brick * side_bricks_ * side_bricks_ + (within << 6));
      index_[1].push_back(brick * side_bricks_ + (within << 3));
      index_[2].push_back(brick + within);
    }
  }

  // Precondition: the cube contains ijk.
  uint32_t IndexOf(const Vec3i& ijk) const {
    return index_[0][static_cast<size_t>(ijk[0] - origin_[0])] + index_[1][static_cast<size_t>(ijk[1] - origin_[1])] +
           index_[2][static_cast<size_t>(ijk[2] - origin_[2])];
  }
  Vec3i VoxelAt(uint32_t index) const {
    const uint32_t brick = index >> 9;
    const Vec3i corner{static_cast<int32_t>(brick / (side_bricks_ * side_bricks_)),
                       static_cast<int32_t>(brick / side_bricks_ % side_bricks_),
                       static_cast<int32_t>(brick % side_bricks_)};
    const Vec3i within{static_cast<int32_t>(index >> 6 & 7), static_cast<int32_t>(index >> 3 & 7),
                       static_cast<int32_t>(index & 7)};
    return origin_ + corner * kBrickSide + within;
  }

  bool Test(uint32_t index) const { return words_[index >> 6] >> (index & 63) & 1; }
  void Set(uint32_t index) { words_[index >> 6] |= uint64_t{1} << (index & 63); }
  void Clear(uint32_t index) { words_[index >> 6] &= ~(uint64_t{1} << (index & 63)); }

  // Calls f(ijk, index) for every member in `box`, which the cube must contain.
  template <class F>
  void ForEachIn(const IndexBox& box, F&& f) const {
    const Vec3i low = box.min - origin_, high = box.max - origin_;
    // The voxels low .. high-1 of a brick's row, as bits of a byte.
    const auto row = [](int32_t first, int32_t last, int32_t brick) {
      const int32_t from = std::max(first - brick * 8, 0), to = std::min(last - brick * 8, 8);
      return (uint32_t{1} << to) - (uint32_t{1} << from);
    };
    for (int32_t by = low[1] >> 3; by * 8 < high[1]; ++by) {
      for (int32_t bz = low[2] >> 3; bz * 8 < high[2]; ++bz) {
        const uint64_t in_row = row(low[2], high[2], bz);
        const uint32_t rows = row(low[1], high[1], by);
        uint64_t wanted = 0;
        for (int y = 0; y < 8; ++y) wanted |= (rows >> y & 1) != 0 ? in_row << (8 * y) : 0;
        for (int32_t x = low[0]; x < high[0]; ++x) {
          const uint32_t word =
              ((static_cast<uint32_t>(x >> 3) * side_bricks_ + static_cast<uint32_t>(by)) * side_bricks_ +
               static_cast<uint32_t>(bz)) *
                  8 +
              (static_cast<uint32_t>(x) & 7);
          for (uint64_t bits = words_[word] & wanted; bits != 0; bits &= bits - 1) {
            const int bit = std::countr_zero(bits);
            f(origin_ + Vec3i{x, by * 8 + (bit >> 3), bz * 8 + (bit & 7)}, word * 64 + static_cast<uint32_t>(bit));
          }
        }
      }
    }
  }

  const std::vector<uint64_t>& words() const { return words_; }
  // An empty set over the same cube.
  TileBox EmptyLike() const {
    TileBox box = *this;
    box.words_.assign(words_.size(), 0);
    return box;
  }

 private:
  Vec3i origin_;
  uint32_t side_bricks_;
  std::array<std::vector<uint32_t>, 3> index_;  // of a voxel, by axis: the sum of three
  std::vector<uint64_t> words_;
};

// The parity class of a voxel, 0..7, from its index: cubes begin at even coordinates. Two k-neighbours never share it,
// since a neighbour step is never 0 modulo 2.
constexpr uint32_t ParityClass(uint32_t index) { return (index >> 6 & 1) << 2 | (index >> 3 & 1) << 1 | (index & 1); }
inline constexpr int kParityClasses = 8;

}  // namespace latvox

#endif  // LATVOX_CORE_TILE_TILE_BOX_H_
