#include "core/snap/snap.h"

#include <oneapi/tbb/blocked_range.h>

#include <cmath>
#include <utility>

#include "core/base/metered.h"
#include "core/snap/lattice_map.h"
#include "core/snap/mesh_range.h"
#include "core/snap/range_check.h"

namespace latvox {
namespace {

using oneapi::tbb::blocked_range;
using Part = blocked_range<size_t>;

constexpr size_t kGrain = 4096;  // vertices for each task
constexpr RangeWords kWords{"voxel_size", "the mesh", "the mesh extends", "voxels"};

// The rounding of vertices, as their range requires.
struct Rounding {
  LatticeMap map;
  LatticeRange range;
  Vec3i base_ijk;
  IndexBox box;
};

absl::StatusOr<Rounding> RoundingOf(const TriangleMesh& mesh, const Lattice& lattice, const Vec3d& origin,
                                    const Vec3i& reach, StopSignal stop) {
  const LatticeMap map{lattice.inverse(), origin};
  const LatticeRange range = RangeOf(mesh, map, stop);
  if (stop.Stopped()) return absl::CancelledError("voxelization cancelled");
  if (auto status = CheckRange(range.min, range.max, lattice.voxel_size(), kWords); !status.ok()) return status;
  Rounding rounding{map, range, {}, {}};
  for (size_t m = 0; m < 3; ++m) {
    // One unit below, because rounding may move the lowest vertex that far; a multiple of a tile, for bricks and
    // parity.
    const auto low = static_cast<int32_t>(std::floor(range.min[m] - 1.0 / kLatticeUnit));
    rounding.base_ijk[m] = low & ~(kTileSide - 1);
    // The nearer end of a crossed link lies within reach/2 of the surface.
    const double half = reach[m] / 2.0;
    const auto unit = [](double x) { return std::nearbyint(x * kLatticeUnit) / kLatticeUnit; };
    rounding.box.min[m] = static_cast<int32_t>(std::ceil(unit(range.min[m]) - half)) - rounding.base_ijk[m];
    rounding.box.max[m] = static_cast<int32_t>(std::floor(unit(range.max[m]) + half)) - rounding.base_ijk[m] + 1;
  }
  return rounding;
}

// Vertices that no triangle uses may lie anywhere; they are clamped, and never read.
//   out   may be the own memory of float vertices
template <class Vertex>
void Round(const Rounding& rounding, const PaddedVector<Vertex>& vertices, Vec3i* out, StopSignal stop) {
  MeteredFor(Part(0, vertices.size(), kGrain), [&](const Part& part) {
    if (stop.Stopped()) return;
    RoundVertices(rounding.map, rounding.range, rounding.base_ijk, &vertices[part.begin()], part.size(),
                  out + part.begin());
  });
}

}  // namespace

// Rounds floats in place, because it takes longer to allocate other memory than to round them.
absl::StatusOr<SnappedMesh> Snap(TriangleMesh mesh, const Lattice& lattice, const Vec3d& origin, const Vec3i& reach,
                                 StopSignal stop) {
  static_assert(sizeof(Vec3i) == sizeof(Vec3f));
  static_assert(alignof(Vec3i) == alignof(Vec3f));
  auto rounding = RoundingOf(mesh, lattice, origin, reach, stop);
  if (!rounding.ok()) return rounding.status();
  auto taken = std::make_shared<TriangleMesh>(std::move(mesh));
  if (!taken->double_vertices.empty()) {
    PaddedVector<Vec3i> vertices_lat(taken->vertex_count());
    Round(*rounding, taken->double_vertices, vertices_lat.data(), stop);
    taken->double_vertices = {};
    return SnappedMesh{rounding->base_ijk, std::move(vertices_lat), {taken, taken->triangles}, rounding->box};
  }
  auto* const out = reinterpret_cast<Vec3i*>(taken->vertices.data());
  Round(*rounding, taken->vertices, out, stop);
  return SnappedMesh{
      rounding->base_ijk, {taken, {out, taken->vertices.size()}}, {taken, taken->triangles}, rounding->box};
}

absl::StatusOr<SnappedMesh> Snap(std::shared_ptr<const TriangleMesh> mesh, const Lattice& lattice, const Vec3d& origin,
                                 const Vec3i& reach, StopSignal stop) {
  auto rounding = RoundingOf(*mesh, lattice, origin, reach, stop);
  if (!rounding.ok()) return rounding.status();
  PaddedVector<Vec3i> vertices_lat(mesh->vertex_count());
  VisitVertices(*mesh, [&](const auto& vertices) { Round(*rounding, vertices, vertices_lat.data(), stop); });
  return SnappedMesh{rounding->base_ijk, std::move(vertices_lat), {mesh, mesh->triangles}, rounding->box};
}

}  // namespace latvox
