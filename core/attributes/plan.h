// How far from a voxel its nearest triangle may be.
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
  double most;          // more than the square of the distance from a voxel to the mesh, units of the metric
  Vec3i margin, reach;  // how far along each lattice axis the nearest triangle may be: in units, and in voxels
};

// What voxels are to carry.
struct CarriedAttributes {
  AttributePlan plan;
  uint32_t count;                     // at least 1
  std::vector<uint32_t> of_vertices;  // as TriangleMesh::attributes
};

// Of voxels that separate, which are ends of links along the frames that the mesh crosses in their nearer half;
// or of a supercover, whose cells meet the mesh. These reach no farther than half the diagonal of a box whose sides are
// as long as the basis vectors: the nearest plane method finds a lattice point within that of any point.
// Errors: INVALID_ARGUMENT as MakeMetric, MarginOf.
absl::StatusOr<AttributePlan> MakeAttributePlan(const Lattice& lattice, const std::vector<Frame>& frames,
                                                bool supercover);

}  // namespace latvox

#endif  // LATVOX_CORE_ATTRIBUTES_PLAN_H_
