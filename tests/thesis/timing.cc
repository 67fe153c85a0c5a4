#include "tests/thesis/timing.h"

#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <bit>
#include <ctime>
#include <limits>
#include <map>
#include <utility>

#include "core/base/kept_memory.h"
#include "core/base/stop_signal.h"
#include "core/thesis/brute_force.h"
#include "core/thesis/incremental.h"
#include "core/thesis/seams.h"
#include "core/thesis/thesis.h"
#include "core/voxelizer/voxelizer.h"

namespace latvox::thesis {
namespace {

double ProcessorSeconds() {
  timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Returns the least of several runs: as many as take 10 ms, at least two.
template <class Run>
double LeastSeconds(const Run& run) {
  constexpr double kEnough = 0.01;
  double least = std::numeric_limits<double>::infinity(), sum = 0;
  for (int runs = 0; runs < 2 || (sum < kEnough && runs < 200); ++runs) {
    const double start = ProcessorSeconds();
    run();
    const double seconds = ProcessorSeconds() - start;
    least = std::min(least, seconds);
    sum += seconds;
  }
  return least;
}

// An array of bits that holds the mesh.
class BitVolume {
 public:
  explicit BitVolume(const IndexBox& box) : low_(box.min), size_(box.max - box.min) {
    uint64_t points = 1;
    for (int32_t side : size_) points *= static_cast<uint64_t>(side);
    bits_.assign((points + 63) / 64, 0);
  }
  void Set(const Vec3i& ijk) {
    uint64_t place = 0;
    for (size_t m = 0; m < 3; ++m) {
      place = place * static_cast<uint64_t>(size_[m]) + static_cast<uint64_t>(ijk[m] - low_[m]);
    }
    bits_[place / 64] |= uint64_t{1} << place % 64;
  }
  uint64_t Count() const {
    uint64_t count = 0;
    for (uint64_t word : bits_) count += static_cast<uint64_t>(std::popcount(word));
    return count;
  }

 private:
  Vec3i low_, size_;
  std::vector<uint64_t> bits_;
};

// An edge of the rounded mesh with the normals of its triangles.
using EdgeNormals = std::map<std::pair<Vec3i, Vec3i>, std::vector<Vec<int64_t, 3>>>;

EdgeNormals EdgesOf(const std::vector<VoxelTriangle>& triangles) {
  EdgeNormals edges;
  for (const VoxelTriangle& v : triangles) {
    for (size_t n = 0; n < 3; ++n) edges[std::minmax(v[n], v[(n + 1) % 3])].push_back(NormalOf(v));
  }
  return edges;
}

void TimeIncremental(const SnappedMesh& mesh, const Neighborhood& neighborhood, bool optimized, Timing& timing) {
  const std::vector<Vec3i> rounded = RoundedVertices(mesh, neighborhood.lattice);
  std::vector<VoxelTriangle> triangles;
  for (const auto& [v0, v1, v2] : mesh.triangles) triangles.push_back({rounded[v0], rounded[v1], rounded[v2]});
  const EdgeNormals edges = EdgesOf(triangles);
  BitVolume volume(mesh.box);
  const auto emit = [&](const Vec3i& z) { volume.Set(z); };
  const auto scan = [&] {
    for (const VoxelTriangle& triangle : triangles) {
      (optimized ? OptimizedIncrementalTriangle : IncrementalTriangle)(triangle, neighborhood.frames, StopSignal(),
                                                                       emit);
    }
  };
  timing.scan_seconds = LeastSeconds(scan);
  timing.array_seconds = LeastSeconds([&] {
    scan();
    for (const auto& [edge, normals] : edges) Seam(edge.first, edge.second, normals, neighborhood, StopSignal(), emit);
  });
  timing.array_voxels = volume.Count();
}

void TimeBruteForce(const SnappedMesh& mesh, const Neighborhood& neighborhood, Timing& timing) {
  BitVolume volume(mesh.box);
  timing.array_seconds = LeastSeconds([&] {
    for (const auto& [v0, v1, v2] : mesh.triangles) {
      const Triangle triangle{mesh.vertices_lat[v0], mesh.vertices_lat[v1], mesh.vertices_lat[v2]};
      BruteForceTriangle(triangle, neighborhood, StopSignal(), [&](const Vec3i& z) { volume.Set(z); });
    }
  });
  timing.array_voxels = volume.Count();
}

}  // namespace

Timing Time(const TriangleMesh& mesh, const Experiment& experiment, Algorithm algorithm) {
  using oneapi::tbb::global_control;
  const global_control one_thread(global_control::max_allowed_parallelism, 1);
  const Lattice& lattice = experiment.grid.lattice;
  Timing timing;
  const auto call = [&] {
    const VoxelizeOptions options{.separability = experiment.k, .algorithm = algorithm};
    const auto job = VoxelizeJob::Create(mesh, experiment.grid, options).value();
    job->Advance([](TileBricks&&) { return true; }).value();
    timing.voxels = job->totals().voxels;
  };
  timing.seconds = LeastSeconds(call);
  if (algorithm == Algorithm::kExact) {
    KeepJobMemory(0);
    timing.fresh_seconds = LeastSeconds(call);
    KeepJobMemory(kKeptByDefault);
    return timing;
  }
  const Neighborhood neighborhood(lattice, experiment.k);
  const Vec3i reach = ThesisReach(lattice, experiment.k, algorithm);
  const SnappedMesh snapped = Snap(mesh, lattice, experiment.grid.origin, reach).value();
  if (algorithm == Algorithm::kBruteForce) {
    TimeBruteForce(snapped, neighborhood, timing);
  } else {
    TimeIncremental(snapped, neighborhood, algorithm == Algorithm::kOptimizedIncremental, timing);
  }
  return timing;
}

}  // namespace latvox::thesis
