#include "tests/thesis/measure.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <tuple>

#include "core/base/stop_signal.h"
#include "core/digitize/crossing.h"
#include "core/thesis/brute_force.h"
#include "core/thesis/incremental.h"
#include "core/thesis/seams.h"
#include "core/thesis/thesis.h"
#include "core/voxelizer/voxelizer.h"

namespace latvox::thesis {
namespace {

// Collects voxels with the planes that they belong to, one plane a triangle.
class Listing {
 public:
  Listing(const SnappedMesh& mesh, const std::vector<Frame>& frames) : mesh_(mesh), frames_(frames) {}

  const std::vector<Frame>& frames() const { return frames_; }
  size_t triangles() const { return mesh_.triangles.size(); }
  Triangle TriangleAt(uint32_t t) const {
    const auto& [v0, v1, v2] = mesh_.triangles[t];
    return {mesh_.vertices_lat[v0], mesh_.vertices_lat[v1], mesh_.vertices_lat[v2]};
  }
  VoxelTriangle VoxelTriangleAt(uint32_t t, const std::vector<Vec3i>& rounded) const {
    const auto& [v0, v1, v2] = mesh_.triangles[t];
    return {rounded[v0], rounded[v1], rounded[v2]};
  }

  // normal: of the triangle, in lattice coordinates
  void SetPlane(uint32_t triangle, const Vec<int64_t, 3>& normal) {
    plane_ = triangle;
    direction_ = PrincipalFrame(frames_, normal).q;
  }
  void Add(const Vec3i& local) { voxels_.push_back({local + mesh_.base_ijk, direction_, plane_}); }

  // Each voxel, once for each of its planes.
  std::vector<PlaneVoxel> Take() {
    const auto key = [](const PlaneVoxel& v) { return std::tie(v.ijk, v.plane); };
    std::sort(voxels_.begin(), voxels_.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
    const auto same = [&](const auto& a, const auto& b) { return key(a) == key(b); };
    voxels_.erase(std::unique(voxels_.begin(), voxels_.end(), same), voxels_.end());
    return std::move(voxels_);
  }

 private:
  const SnappedMesh& mesh_;
  const std::vector<Frame>& frames_;
  std::vector<PlaneVoxel> voxels_;
  uint32_t plane_ = 0;
  Vec3i direction_{};
};

template <class Visit>
void ForEachVoxel(const VoxelSet& voxels, const Visit& visit) {
  for (const Brick& brick : voxels.Bricks()) {
    for (int32_t n = 0; n < 512; ++n) {
      if (!(brick.mask[static_cast<size_t>(n >> 6)] >> (n & 63) & 1)) continue;
      visit(brick.brick_ijk * kBrickSide + Vec3i{n >> 6, n >> 3 & 7, n & 7});
    }
  }
}

// A triangle in any fixed-point unit.
Vec<int64_t, 3> WideNormal(const Triangle& v) {
  const auto wide = [](const Vec3i& a) { return Vec<int64_t, 3>{a[0], a[1], a[2]}; };
  return Cross(wide(v[1] - v[0]), wide(v[2] - v[0]));
}

// Regions L_e and L_v: within R of the triangle's edges.
std::array<Tube, 3> TubesOf(const Triangle& triangle, const Neighborhood& neighborhood) {
  std::array<Vec3d, 3> v;
  for (size_t n = 0; n < 3; ++n) v[n] = ToDouble(triangle[n]) * (1.0 / kLatticeUnit);
  return {Tube(neighborhood, v[0], v[1]), Tube(neighborhood, v[1], v[2]), Tube(neighborhood, v[2], v[0])};
}

void ListExact(const VoxelSet& voxels, const Vec3i& base_ijk, const Neighborhood& neighborhood, Listing& listing) {
  constexpr int32_t kFar = 1 << 28;
  constexpr IndexBox kEverywhere{{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}};
  for (uint32_t t = 0; t < listing.triangles(); ++t) {
    const Triangle triangle = listing.TriangleAt(t);
    listing.SetPlane(t, WideNormal(triangle));
    for (const Frame& frame : listing.frames()) {
      ForEachCrossing(triangle, frame, kEverywhere, [&](const Vec3i& nearer, const Vec3i&) {
        if (voxels.Contains(nearer + base_ijk)) listing.Add(nearer);
      });
    }
    const std::array<Tube, 3> tubes = TubesOf(triangle, neighborhood);
    ForEachVoxel(voxels, [&](const Vec3i& ijk) {
      const Vec3d point = ToDouble(ijk - base_ijk);
      if (std::any_of(tubes.begin(), tubes.end(), [&](const Tube& tube) { return tube.Contains(point); })) {
        listing.Add(ijk - base_ijk);
      }
    });
  }
}

void ListBruteForce(const Neighborhood& neighborhood, Listing& listing) {
  for (uint32_t t = 0; t < listing.triangles(); ++t) {
    const Triangle triangle = listing.TriangleAt(t);
    listing.SetPlane(t, WideNormal(triangle));
    BruteForceTriangle(triangle, neighborhood, StopSignal(), [&](const Vec3i& z) { listing.Add(z); });
  }
}

void ListIncremental(const std::vector<Vec3i>& rounded, const Neighborhood& neighborhood, bool optimized,
                     Listing& listing) {
  const auto emit = [&](const Vec3i& z) { listing.Add(z); };
  std::map<std::pair<Vec3i, Vec3i>, std::vector<uint32_t>> edges;
  for (uint32_t t = 0; t < listing.triangles(); ++t) {
    const VoxelTriangle triangle = listing.VoxelTriangleAt(t, rounded);
    listing.SetPlane(t, NormalOf(triangle));
    (optimized ? OptimizedIncrementalTriangle : IncrementalTriangle)(triangle, listing.frames(), StopSignal(), emit);
    for (size_t n = 0; n < 3; ++n) edges[std::minmax(triangle[n], triangle[(n + 1) % 3])].push_back(t);
  }
  for (const auto& [edge, triangles] : edges) {
    std::vector<Vec<int64_t, 3>> normals;
    for (uint32_t t : triangles) normals.push_back(NormalOf(listing.VoxelTriangleAt(t, rounded)));
    for (uint32_t t : triangles) {
      listing.SetPlane(t, NormalOf(listing.VoxelTriangleAt(t, rounded)));
      Seam(edge.first, edge.second, normals, neighborhood, StopSignal(), emit);
    }
  }
}

void RequireSameSize(uint64_t listed, uint64_t delivered) {
  if (listed == delivered) return;
  std::fprintf(stderr, "%ju voxels listed by plane, %ju delivered\n", uintmax_t{listed}, uintmax_t{delivered});
  std::abort();
}

}  // namespace

VoxelSet VoxelsBy(Algorithm algorithm, const TriangleMesh& mesh, const Grid& grid, int k) {
  VoxelSet voxels;
  const auto job = VoxelizeJob::Create(mesh, grid, {.separability = k, .algorithm = algorithm}).value();
  const bool done = job->Advance([&](TileBricks&& tile) {
                         for (const Brick& brick : tile.bricks) voxels.Add(brick);
                         return true;
                       })
                        .value();
  if (!done) std::abort();
  return voxels;
}

SnappedMesh Rounded(SnappedMesh mesh, const Lattice& lattice) {
  PaddedVector<Vec3i> vertices_lat;
  for (const Vec3i& v : RoundedVertices(mesh, lattice)) vertices_lat.push_back(v * kLatticeUnit);
  mesh.vertices_lat = std::move(vertices_lat);
  return mesh;
}

Measurement Measure(const Experiment& experiment, double degrees, Algorithm algorithm) {
  const Lattice& lattice = experiment.grid.lattice;
  const auto& frames = lattice.frames(experiment.k);
  const TriangleMesh mesh = RotatedTetrahedron(degrees, experiment.side);
  const SnappedMesh snapped = Snap(mesh, lattice, experiment.grid.origin, {2, 2, 2}).value();
  const VoxelSet voxels = VoxelsBy(algorithm, mesh, experiment.grid, experiment.k);

  Listing listing(snapped, frames);
  const Neighborhood neighborhood(lattice, experiment.k);
  if (algorithm == Algorithm::kExact) {
    ListExact(voxels, snapped.base_ijk, neighborhood, listing);
  } else if (algorithm == Algorithm::kBruteForce) {
    ListBruteForce(neighborhood, listing);
  } else {
    const bool optimized = algorithm == Algorithm::kOptimizedIncremental;
    ListIncremental(RoundedVertices(snapped, lattice), neighborhood, optimized, listing);
  }

  const Flood flood(experiment.volume, voxels, frames);
  Measurement measured;
  measured.voxels = voxels.size();
  measured.displaced = flood.DisplacedVolume();
  measured.minimality = MeasureMinimality(listing.Take(), flood);
  RequireSameSize(measured.minimality.voxels, voxels.size());
  measured.given = CountTunnels(snapped, frames, voxels, StopSignal()).value();
  measured.rounded = CountTunnels(Rounded(snapped, lattice), frames, voxels, StopSignal()).value();
  return measured;
}

}  // namespace latvox::thesis
