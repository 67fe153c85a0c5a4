// Decisions about the fields of a job, before its first tile.
#ifndef LATVOX_CORE_FIELDS_PLAN_H_
#define LATVOX_CORE_FIELDS_PLAN_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/band/metric.h"
#include "core/base/vec.h"
#include "core/lattice/cell_points.h"
#include "core/lattice/lattice.h"
#include "core/request/request.h"

namespace latvox {

struct FieldPlan {
  FieldList fields;   // at least one
  FieldList nearest;  // those among them that come from the nearest triangle; the members below are for these
  bool is_signed;     // distances are negative inside
  bool has_squares;   // tiles bring the squares of their voxels' distances: those of a band
  bool is_searched;   // fields need more than these squares, and more than labels
  // For a labeled set: where the labels stand in `of_mesh`. Points inside of a label have it for their number.
  std::optional<size_t> label_place;
  bool is_label_alone;  // points inside of a label need no search
  Metric metric;
  double most_square;  // of the distance of a searched voxel, in units; infinite if it may be far
  bool are_numbers;    // all of `nearest` are numbers of the mesh
  // With are_numbers, and if searched voxels lie within a brick's side of the mesh: the same bound along each axis of
  // lattice coordinates, in units.
  std::optional<Vec3i> near_reach;
  double unit;                        // world length of a unit of the metric
  double most_distance;               // world units: no distance is longer, as a 32-bit float; infinite without a band
  Mat3d basis;                        // of the lattice, world units
  FieldList of_mesh;                  // the fields of the mesh among `fields`
  std::vector<uint32_t> of_vertices;  // as TriangleMesh::attributes: those of the fields of the mesh
  std::optional<CellPoints> cell;     // for fields of cells
};

// Errors: INVALID_ARGUMENT as MakeMetric and, for a field of cells, as IntegerCell; or if voxels are so small or large
// that 32-bit floats hold no distances.
absl::StatusOr<FieldPlan> MakeFieldPlan(const VoxelRequest& request, const Lattice& lattice,
                                        std::vector<uint32_t> of_vertices);

}  // namespace latvox

#endif  // LATVOX_CORE_FIELDS_PLAN_H_
