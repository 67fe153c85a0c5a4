// A pair of a voxel and a triangle that is asked about it.
#ifndef LATVOX_CORE_TILE_VOXEL_TRIANGLE_H_
#define LATVOX_CORE_TILE_VOXEL_TRIANGLE_H_

#include <cstdint>

namespace latvox {

struct VoxelTriangle {
  uint32_t voxel;     // a number of the BitsLayout
  uint32_t triangle;  // of the mesh
};

}  // namespace latvox

#endif  // LATVOX_CORE_TILE_VOXEL_TRIANGLE_H_
