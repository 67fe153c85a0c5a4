// A mesh of long thin triangles.
#ifndef LATVOX_TESTS_BENCH_WIRES_H_
#define LATVOX_TESTS_BENCH_WIRES_H_

#include <cstdint>

#include "core/mesh/mesh.h"

namespace latvox {

// Returns straight wires across a unit cube, each from a random point of a side to one of the opposite side. A wire has
// 16 triangles, and no ends. It is half a voxel thick at 128 voxels, so every voxel of it may be redundant. The same
// number gives the same mesh.
TriangleMesh Wires(uint32_t count);

}  // namespace latvox

#endif  // LATVOX_TESTS_BENCH_WIRES_H_
