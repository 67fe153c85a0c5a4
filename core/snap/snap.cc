#include "core/snap/snap.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <atomic>
#include <cmath>
#include <utility>

#include "absl/strings/str_format.h"
#include "core/base/refusal.h"
#include "core/snap/lattice_map.h"
#include "core/snap/mesh_range.h"

namespace latvox {
namespace {

using oneapi::tbb::blocked_range;
using Part = blocked_range<size_t>;

constexpr size_t kGrain = 4096;  // vertices a task
constexpr char kAxisName[] = "ijk";

// How far the mesh reaches is told first: where it is too far, so may be where it lies, and no origin would help.
absl::Status CheckRange(const LatticeRange& range, double voxel_size) {
  constexpr double kMaxPosition = 1 << kPositionBits;
  for (size_t m = 0; m < 3; ++m) {
    const double extent = std::floor(range.max[m]) - std::floor(range.min[m]) + 1;
    if (extent > kMaxExtent) {
      return WithValue(absl::InvalidArgumentError(absl::StrFormat(
                           "voxel_size: at %g the mesh extends over %.0f voxels on lattice axis %c, the limit is %d",
                           voxel_size, extent, kAxisName[m], kMaxExtent)),
                       extent, kMaxExtent);
    }
  }
  for (size_t m = 0; m < 3; ++m) {
    for (double x : {range.min[m], range.max[m]}) {
      if (std::abs(x) <= kMaxPosition) continue;  // else, and if it is no number
      return WithValue(absl::InvalidArgumentError(absl::StrFormat(
                           "origin: it puts the mesh at lattice coordinate %g on axis %c, the limit is %.0f", x,
                           kAxisName[m], kMaxPosition)),
                       x, kMaxPosition);
    }
  }
  return absl::OkStatus();
}

// Without triangles.
absl::StatusOr<SnappedMesh> SnapVertices(const TriangleMesh& mesh, const Lattice& lattice, const Vec3d& origin,
                                         const Vec3i& reach, const std::atomic<bool>& cancelled) {
  const LatticeMap map{lattice.inverse(), origin};
  const LatticeRange range = RangeOf(mesh, map, cancelled);
  if (cancelled) return absl::CancelledError("voxelization cancelled");
  if (auto status = CheckRange(range, lattice.voxel_size()); !status.ok()) return status;
  SnappedMesh snapped;
  for (size_t m = 0; m < 3; ++m) {
    // One unit below, since rounding may move the lowest vertex that far; a tile's multiple, for bricks and parity.
    const auto low = static_cast<int32_t>(std::floor(range.min[m] - 1.0 / kLatticeUnit));
    snapped.base_ijk[m] = low & ~(kTileSide - 1);
  }

  // Vertices that no triangle uses may lie anywhere; they are clamped, and never read.
  snapped.vertices_lat.resize(mesh.vertices.size());
  oneapi::tbb::parallel_for(Part(0, mesh.vertices.size(), kGrain), [&](const Part& part) {
    if (cancelled) return;
    RoundVertices(map, range, snapped.base_ijk, &mesh.vertices[part.begin()], part.size(),
                  &snapped.vertices_lat[part.begin()]);
  });

  for (size_t m = 0; m < 3; ++m) {
    // The nearer end of a crossed edge lies within reach/2 of the surface.
    const double half = reach[m] / 2.0;
    const auto unit = [](double x) { return std::nearbyint(x * kLatticeUnit) / kLatticeUnit; };
    snapped.box.min[m] = static_cast<int32_t>(std::ceil(unit(range.min[m]) - half)) - snapped.base_ijk[m];
    snapped.box.max[m] = static_cast<int32_t>(std::floor(unit(range.max[m]) + half)) - snapped.base_ijk[m] + 1;
  }
  return snapped;
}

}  // namespace

absl::StatusOr<SnappedMesh> Snap(TriangleMesh mesh, const Lattice& lattice, const Vec3d& origin, const Vec3i& reach,
                                 const std::atomic<bool>& cancelled) {
  auto snapped = SnapVertices(mesh, lattice, origin, reach, cancelled);
  if (snapped.ok()) snapped->triangles = std::move(mesh.triangles);
  return snapped;
}

absl::StatusOr<SnappedMesh> Snap(std::shared_ptr<const TriangleMesh> mesh, const Lattice& lattice, const Vec3d& origin,
                                 const Vec3i& reach, const std::atomic<bool>& cancelled) {
  auto snapped = SnapVertices(*mesh, lattice, origin, reach, cancelled);
  if (snapped.ok()) snapped->triangles = SharedTriangles(std::move(mesh));
  return snapped;
}

}  // namespace latvox
