// The distance from a voxel within which its nearest triangle lies.
#ifndef LATVOX_CORE_ATTRIBUTES_PLAN_H_
#define LATVOX_CORE_ATTRIBUTES_PLAN_H_

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/band/metric.h"
#include "core/base/vec.h"
#include "core/lattice/frame.h"
#include "core/lattice/lattice.h"

namespace latvox {

struct AttributePlan {
  Metric metric;
  double most;  // more than the square of the distance from a voxel to the mesh, in units of the metric
  Vec3i margin,
      reach;  // the distance along each lattice axis within which the nearest triangle lies: in units, and in voxels
};

// The attributes that voxels carry.
struct CarriedAttributes {
  AttributePlan plan;
  uint32_t count;                     // at least 1
  std::vector<uint32_t> of_vertices;  // as TriangleMesh::attributes
};

// For separating voxels: each is an end of a link along a frame, and the mesh crosses the nearer half of that link. Or
// for a supercover, with cells that meet the mesh. A cell reaches no farther than half the diagonal of a box with sides
// as long as the basis vectors. The reason is that the nearest plane method finds a lattice point within that distance
// of any point.
// Errors: INVALID_ARGUMENT as MakeMetric, MarginOf.
absl::StatusOr<AttributePlan> MakeAttributePlan(const Lattice& lattice, const std::vector<Frame>& frames,
                                                bool supercover);

}  // namespace latvox

#endif  // LATVOX_CORE_ATTRIBUTES_PLAN_H_
