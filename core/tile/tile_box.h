// A dense set of voxels around one tile.
#ifndef LATVOX_CORE_TILE_TILE_BOX_H_
#define LATVOX_CORE_TILE_TILE_BOX_H_

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
  }

  // Precondition: the cube contains ijk.
  uint32_t IndexOf(const Vec3i& ijk) const {
    const auto x = static_cast<uint32_t>(ijk[0] - origin_[0]), y = static_cast<uint32_t>(ijk[1] - origin_[1]),
               z = static_cast<uint32_t>(ijk[2] - origin_[2]);
    const uint32_t brick = ((x >> 3) * side_bricks_ + (y >> 3)) * side_bricks_ + (z >> 3);
    return brick << 9 | (x & 7) << 6 | (y & 7) << 3 | (z & 7);
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
  std::vector<uint64_t> words_;
};

// The parity class of a voxel, 0..7, from its index: cubes begin at even coordinates. Two k-neighbours never share it,
// since a neighbour step is never 0 modulo 2.
constexpr uint32_t ParityClass(uint32_t index) { return (index >> 6 & 1) << 2 | (index >> 3 & 1) << 1 | (index & 1); }
inline constexpr int kParityClasses = 8;

}  // namespace latvox

#endif  // LATVOX_CORE_TILE_TILE_BOX_H_
