// What voxels carry of the mesh, besides being there.
//
// Each vertex has some numbers. A voxel's are those of the nearest corner of the nearest triangle: among all triangles
// at the least distance from its lattice point, of all their corners those at the least distance from it, and of these
// the least value of each number by itself. Distances are compared exactly, in integers (core/band/metric.h), so that
// the voxels' numbers depend on the mesh as a set of triangles alone: not on their order, on tiles or on regions.
#ifndef LATVOX_CORE_ATTRIBUTES_ATTRIBUTES_H_
#define LATVOX_CORE_ATTRIBUTES_ATTRIBUTES_H_

#include <cstdint>

#include "core/request/fields.h"

namespace latvox {

// Numbers of a vertex.
inline constexpr uint32_t kMaxAttributes = kFields.size();

}  // namespace latvox

#endif  // LATVOX_CORE_ATTRIBUTES_ATTRIBUTES_H_
