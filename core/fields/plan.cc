#include "core/fields/plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/base/status_payload.h"
#include "core/brick/brick.h"
#include "core/lattice/frame.h"
#include "core/lattice/integer_cell.h"
#include "core/snap/snap.h"

namespace latvox {
namespace {

// Distances are between 2^-40 of a voxel size, or 0, and 2^19 of it.
absl::Status CheckDistances(double size) {
  constexpr double kLeast = 0x1p-86, kMost = 0x1p108;
  if (size >= kLeast && size <= kMost) return absl::OkStatus();
  return WithField(absl::InvalidArgumentError(absl::StrFormat(
                       "fields: for distances, the voxel size %g is not within %g and %g", size, kLeast, kMost)),
                   "fields", absl::StrFormat("%g", size), absl::StrFormat("%g", size < kLeast ? kLeast : kMost));
}

// Where the labels of a labeled set stand among the fields of the mesh.
std::optional<size_t> PlaceOfLabels(const VoxelRequest& request) {
  const std::optional<LabelRequest> labels = request.labels();
  if (!labels) return std::nullopt;
  const FieldList of_mesh = request.fields.OfMesh();
  return static_cast<size_t>(std::ranges::find(of_mesh, labels->field) - of_mesh.begin());
}

// The distance from the mesh of voxels that are searched, world units; infinite if there is no bound. A separating
// voxel is an end of a link along a frame, and the mesh crosses the nearer half of that link. A voxel of links is
// either end. The cell of a supercover's voxel meets the mesh. It reaches no farther than half the diagonal of a box
// with sides as long as the basis vectors, because the nearest plane method finds a lattice point within that distance
// of any point.
double FarthestVoxel(const VoxelRequest& request, const Lattice& lattice, bool is_label_alone) {
  const bool has_inside = request.is_filled() && !is_label_alone;
  if (request.band() != nullptr || has_inside) return std::numeric_limits<double>::infinity();
  const Mat3d& basis = lattice.basis();
  if (request.is_supercover()) return LengthOf({LengthOf(basis[0]), LengthOf(basis[1]), LengthOf(basis[2])}) / 2;
  double longest = 0;
  for (const Frame& frame : lattice.frames(request.separability)) {
    longest = std::max(longest, LengthOf(Apply(basis, ToDouble(frame.q))));
  }
  return request.links() != nullptr ? longest : longest / 2;
}

// Returns how far a vector of that length reaches along each axis of lattice coordinates, in units. The rows of root^-1
// are the columns of cofactor over the determinant. Returns nullopt if that is more than a brick's side: on a flat
// lattice, many tiles would each list most of the mesh.
std::optional<Vec3i> ReachOf(const Metric& metric, double length) {
  Vec3i reach;
  for (size_t m = 0; m < 3; ++m) {
    const double units = length * LengthOf(metric.cofactor[m]) / std::abs(metric.determinant) + 1;
    if (units > kBrickSide * kLatticeUnit) return std::nullopt;
    reach[m] = static_cast<int32_t>(units);
  }
  return reach;
}

}  // namespace

absl::StatusOr<FieldPlan> MakeFieldPlan(const VoxelRequest& request, const Lattice& lattice,
                                        std::vector<uint32_t> of_vertices) {
  const double size = lattice.voxel_size();
  if (request.fields.Contains(Field::kDistance)) {
    if (absl::Status status = CheckDistances(size); !status.ok()) return status;
  }
  const FieldList nearest = request.fields.OfNearest();
  const absl::StatusOr<Metric> metric = nearest.empty() ? Metric{} : MakeMetric(lattice);
  if (!metric.ok()) return metric.status();
  std::optional<CellPoints> points;
  if (!request.fields.OfCells().empty()) {
    const absl::StatusOr<IntegerCell> cell = IntegerCell::Of(lattice);
    if (!cell.ok()) return cell.status();
    points = PointsOf(*cell, static_cast<int32_t>(request.fraction_n));
  }
  constexpr double kSlack = 1 + 0x1p-16;  // for rounding, including that of the metric and of a supercover's cell
  const bool has_band = request.band() != nullptr;
  const std::optional<size_t> label_place = PlaceOfLabels(request);
  const bool is_label_alone = label_place && nearest.size() == 1;
  const double farthest = FarthestVoxel(request, lattice, is_label_alone) / size * kLatticeUnit * kSlack;
  const bool all_have_labels = request.walk() != nullptr || !request.has_surface();  // each voxel of a labeled set
  const bool is_searched =
      !nearest.empty() && (has_band ? nearest != FieldList{Field::kDistance} : !is_label_alone || !all_have_labels);
  std::optional<Vec3i> near_reach;
  const bool are_numbers = request.fields.OfMesh() == nearest;
  if (is_searched && std::isfinite(farthest) && are_numbers) {
    near_reach = ReachOf(*metric, farthest);
  }
  return FieldPlan{
      .fields = request.fields,
      .nearest = nearest,
      .is_signed = request.signed_distance,
      .has_squares = has_band,
      .is_searched = is_searched,
      .label_place = label_place,
      .is_label_alone = is_label_alone,
      .metric = *metric,
      .most_square = farthest * farthest,
      .are_numbers = are_numbers,
      .near_reach = near_reach,
      .unit = size / kLatticeUnit,
      .most_distance = has_band ? WidthOf(*request.band(), lattice) : std::numeric_limits<double>::infinity(),
      .basis = lattice.basis(),
      .of_mesh = request.fields.OfMesh(),
      .of_vertices = std::move(of_vertices),
      .cell = std::move(points)};
}

}  // namespace latvox
