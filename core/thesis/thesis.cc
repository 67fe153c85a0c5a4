#include "core/thesis/thesis.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/base/metered.h"
#include "core/base/sort.h"
#include "core/thesis/brute_force.h"
#include "core/thesis/degenerate.h"
#include "core/thesis/incremental.h"
#include "core/thesis/neighborhood.h"
#include "core/thesis/seams.h"

namespace latvox {
namespace {

using oneapi::tbb::blocked_range;

// Collects the voxels that `task(n, emit)` emits for n in 0 .. count-1, in parallel.
template <class Task>
VoxelSet Collect(size_t count, const Vec3i& base_ijk, StopSignal stop, const Task& task) {
  oneapi::tbb::enumerable_thread_specific<VoxelSet> parts;
  MeteredFor(blocked_range<size_t>(0, count), [&](const blocked_range<size_t>& range) {
    VoxelSet& part = parts.local();
    const auto emit = [&](const Vec3i& local) { part.Insert(local + base_ijk); };
    for (size_t n = range.begin(); n < range.end() && !stop.Stopped(); ++n) task(n, emit);
  });
  VoxelSet all;
  for (VoxelSet& part : parts) {
    if (all.size() < part.size()) std::swap(all, part);
    all.Add(part, stop);
  }
  return all;
}

// An edge of a triangle, its ends numbers of vertices, the lower first.
struct EdgeUse {
  uint32_t low, high, triangle;
  bool operator<(const EdgeUse& other) const {
    return std::tie(low, high, triangle) < std::tie(other.low, other.high, other.triangle);
  }
  bool SameEdge(const EdgeUse& other) const { return low == other.low && high == other.high; }
};

// The mesh on the lattice: vertices rounded, and welded where that brings them together.
class RoundedMesh {
 public:
  RoundedMesh(const SnappedMesh& mesh, const Lattice& lattice, StopSignal stop)
      : rounded_(RoundedVertices(mesh, lattice, stop)), points_(rounded_), triangles_(mesh.triangles) {
    SortUnique(points_, stop);
  }

  size_t triangles() const { return triangles_.size(); }
  VoxelTriangle At(size_t n) const {
    const auto& [v0, v1, v2] = triangles_[n];
    return {rounded_[v0], rounded_[v1], rounded_[v2]};
  }
  const Vec3i& PointAt(uint32_t number) const { return points_[number]; }

  // The edges of all triangles with area, sorted.
  std::vector<EdgeUse> Edges(StopSignal stop) const {
    std::vector<EdgeUse> edges;
    for (size_t t = 0; t < triangles_.size() && !stop.Stopped(); ++t) {
      const VoxelTriangle v = At(t);
      if (NormalOf(v) == Vec<int64_t, 3>{}) continue;
      const std::array<uint32_t, 3> number{NumberOf(v[0]), NumberOf(v[1]), NumberOf(v[2])};
      for (size_t n = 0; n < 3; ++n) {
        const auto [low, high] = std::minmax(number[n], number[(n + 1) % 3]);
        edges.push_back({low, high, static_cast<uint32_t>(t)});
      }
    }
    Sort(edges, stop);
    return edges;
  }

 private:
  uint32_t NumberOf(const Vec3i& point) const {
    return static_cast<uint32_t>(std::lower_bound(points_.begin(), points_.end(), point) - points_.begin());
  }

  std::vector<Vec3i> rounded_, points_;
  const SharedArray<std::vector<std::array<uint32_t, 3>>> triangles_;
};

VoxelSet BruteForce(const SnappedMesh& mesh, const Neighborhood& neighborhood, StopSignal stop) {
  return Collect(mesh.triangles.size(), mesh.base_ijk, stop,
                 [&](size_t n, EmitVoxel emit) { BruteForceTriangle(mesh.TriangleAt(n), neighborhood, stop, emit); });
}

VoxelSet Seams(const RoundedMesh& mesh, const Vec3i& base_ijk, const Neighborhood& neighborhood, StopSignal stop) {
  const std::vector<EdgeUse> edges = mesh.Edges(stop);
  return Collect(edges.size(), base_ijk, stop, [&](size_t n, EmitVoxel emit) {
    if (n > 0 && edges[n].SameEdge(edges[n - 1])) return;
    std::vector<Vec<int64_t, 3>> normals;
    for (size_t use = n; use < edges.size() && edges[use].SameEdge(edges[n]) && !stop.Stopped(); ++use) {
      normals.push_back(NormalOf(mesh.At(edges[use].triangle)));
    }
    Seam(mesh.PointAt(edges[n].low), mesh.PointAt(edges[n].high), normals, neighborhood, stop, emit);
  });
}

VoxelSet Incremental(const SnappedMesh& snapped, const Neighborhood& neighborhood, bool optimized, StopSignal stop) {
  const RoundedMesh mesh(snapped, neighborhood.lattice, stop);
  // Lines separate nothing, but seams do. So lines use all of the lattice's steps, which gives the fewest voxels.
  const LineTracer tracer(Neighborhood(neighborhood.lattice, 0));
  VoxelSet voxels = Collect(mesh.triangles(), snapped.base_ijk, stop, [&](size_t n, EmitVoxel emit) {
    const VoxelTriangle triangle = mesh.At(n);
    if (NormalOf(triangle) == Vec<int64_t, 3>{}) {
      DegenerateTriangle(triangle, tracer, emit);
    } else if (optimized) {
      OptimizedIncrementalTriangle(triangle, neighborhood.frames, stop, emit);
    } else {
      IncrementalTriangle(triangle, neighborhood.frames, stop, emit);
    }
  });
  if (!stop.Stopped()) voxels.Add(Seams(mesh, snapped.base_ijk, neighborhood, stop), stop);
  return voxels;
}

}  // namespace

std::vector<Vec3i> RoundedVertices(const SnappedMesh& mesh, const Lattice& lattice, StopSignal stop) {
  std::vector<Vec3i> rounded(mesh.vertices_lat.size());
  constexpr size_t kGrain = 1024;
  MeteredFor(blocked_range<size_t>(0, rounded.size(), kGrain), [&](const blocked_range<size_t>& range) {
    for (size_t n = range.begin(); n < range.end() && !stop.Stopped(); ++n) {
      rounded[n] = NearestLatticePoint(lattice, ToDouble(mesh.vertices_lat[n]) * (1.0 / kLatticeUnit));
    }
  });
  return rounded;
}

// Brute force: R. Incremental: rounding moves the surface by the covering radius at most, and seams and lines lie
// within R of it, lines within 2R of N_0.
Vec3i ThesisReach(const Lattice& lattice, int k, Algorithm algorithm) {
  const Neighborhood neighborhood(lattice, k);
  const double line = 2 * Neighborhood(lattice, 0).radius;
  const double distance =
      algorithm == Algorithm::kBruteForce ? neighborhood.radius : neighborhood.covering_radius_max + line;
  Vec3i reach;
  for (size_t m = 0; m < 3; ++m) {
    reach[m] = 2 * static_cast<int32_t>(std::ceil(neighborhood.ball[m] * distance / neighborhood.radius));
  }
  return reach;
}

absl::StatusOr<VoxelSet> VoxelizeByThesis(const SnappedMesh& mesh, const Lattice& lattice, int k, Algorithm algorithm,
                                          StopSignal stop) {
  const Neighborhood neighborhood(lattice, k);
  VoxelSet voxels = algorithm == Algorithm::kBruteForce
                        ? BruteForce(mesh, neighborhood, stop)
                        : Incremental(mesh, neighborhood, algorithm == Algorithm::kOptimizedIncremental, stop);
  if (stop.Stopped()) return absl::CancelledError("voxelization cancelled");
  return voxels;
}

absl::StatusOr<VoxelSet> VoxelizeByThesis(const TriangleMesh& mesh, const Grid& grid, int k, Algorithm algorithm,
                                          StopSignal stop) {
  const auto snapped = Snap(mesh, grid.lattice, grid.origin, ThesisReach(grid.lattice, k, algorithm));
  if (!snapped.ok()) return snapped.status();
  return VoxelizeByThesis(*snapped, grid.lattice, k, algorithm, stop);
}

}  // namespace latvox
