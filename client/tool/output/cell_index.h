// Arithmetic of lattice coordinates.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_CELL_INDEX_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_CELL_INDEX_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "latvox/types.h"

namespace latvox::client {

inline Vec3i Plus(const Vec3i& a, const Vec3i& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }

inline Vec3i ShiftRight(const Vec3i& v, int by) { return {v[0] >> by, v[1] >> by, v[2] >> by}; }

// Inline, unlike the comparison of arrays, which calls the standard library.
inline bool Same(const Vec3i& a, const Vec3i& b) { return ((a[0] ^ b[0]) | (a[1] ^ b[1]) | (a[2] ^ b[2])) == 0; }

// Faster than the functions of the standard library. Precondition: less than 2^20 from 0.
inline Vec3i Rounded(const Vec3d& v) {
  constexpr int32_t kBeyond = 1 << 20;
  Vec3i out;
  for (size_t m = 0; m < 3; ++m) out[m] = static_cast<int32_t>(v[m] + (kBeyond + 0.5)) - kBeyond;
  return out;
}

// Returns the index of a voxel in its brick, 0 to 511.
inline size_t VoxelInBrick(const Vec3i& ijk) {
  return static_cast<size_t>((ijk[0] & 7) << 6 | (ijk[1] & 7) << 3 | (ijk[2] & 7));
}

// Returns the index of a brick in its tile, 0 to 511.
inline size_t BrickInTile(const Vec3i& brick_ijk) { return VoxelInBrick(brick_ijk); }

// Returns bit (y << 3 | z) of word x: a voxel in the mask of its brick.
inline uint64_t BitInWord(const Vec3i& ijk) { return uint64_t{1} << ((ijk[1] & 7) << 3 | (ijk[2] & 7)); }
inline size_t WordInBrick(const Vec3i& ijk) { return static_cast<size_t>(ijk[0] & 7); }

inline bool HasVoxel(const decltype(Brick::mask)& mask, const Vec3i& ijk) {
  return (mask[WordInBrick(ijk)] & BitInWord(ijk)) != 0;
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_CELL_INDEX_H_
