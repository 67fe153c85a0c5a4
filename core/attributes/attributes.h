// The numbers of the mesh that voxels carry.
//
// Each vertex has some numbers. A voxel gets those of the nearest corner of the nearest triangle. Several triangles may
// be at the smallest distance from the lattice point, and several of their corners may be nearest to it. Then the voxel
// gets the smallest value of each number, number by number. Distances are compared exactly, in integers
// (core/band/metric.h). So a voxel's numbers depend on the mesh as a set of triangles alone: not on their order, on
// tiles or on regions.
#ifndef LATVOX_CORE_ATTRIBUTES_ATTRIBUTES_H_
#define LATVOX_CORE_ATTRIBUTES_ATTRIBUTES_H_

#include <cstdint>

#include "core/request/fields.h"

namespace latvox {

// Numbers of a vertex.
inline constexpr uint32_t kMaxAttributes = kFields.size();

}  // namespace latvox

#endif  // LATVOX_CORE_ATTRIBUTES_ATTRIBUTES_H_
