#include "core/voxelizer/estimate.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace latvox {
namespace {

using Corners = std::array<Vec3d, 3>;

double LengthOf(const Vec3d& v) { return std::sqrt(Dot(v, v)); }

double TwiceAreaOf(const Corners& corners) {
  const auto& [a, b, c] = corners;
  return LengthOf(Cross(b - a, c - a));
}

double LengthAround(const Corners& corners) {
  const auto& [a, b, c] = corners;
  return LengthOf(b - a) + LengthOf(c - b) + LengthOf(a - c);
}

// Of the corners' box and a margin, in voxels.
double VolumeAround(const Corners& corners, double size) {
  const auto& [a, b, c] = corners;
  double volume = 1;
  for (size_t m = 0; m < 3; ++m) {
    const auto [low, high] = std::minmax({a[m], b[m], c[m]});
    volume *= (high - low) / size + 4;
  }
  return volume;
}

template <class F>
double SumOver(const TriangleMesh& mesh, const F& f) {
  using Part = oneapi::tbb::blocked_range<size_t>;
  constexpr size_t kGrain = 16384;  // triangles a task
  return oneapi::tbb::parallel_deterministic_reduce(
      Part(0, mesh.triangles.size(), kGrain), 0.0,
      [&](const Part& part, double sum) {
        for (size_t t = part.begin(); t < part.end(); ++t) {
          Corners corners;
          for (size_t n = 0; n < 3; ++n) {
            const Vec3f& v = mesh.vertices[mesh.triangles[t][n]];
            corners[n] = {v[0], v[1], v[2]};
          }
          sum += f(corners);
        }
        return sum;
      },
      std::plus<>());
}

double VolumeOf(const IndexBox& box) {
  double volume = 1;
  for (size_t m = 0; m < 3; ++m)
    volume *= std::max(0.0, static_cast<double>(box.max[m]) - static_cast<double>(box.min[m]));
  return volume;
}

}  // namespace

double EstimateVoxels(const TriangleMesh& mesh, const Grid& grid, const VoxelizeOptions& options) {
  const double size = grid.lattice.voxel_size();
  if (options.algorithm == Algorithm::kExact) {
    const double voxels = SumOver(mesh, [&](const Corners& corners) { return TwiceAreaOf(corners); }) / (size * size);
    const double delivered = options.region ? std::min(voxels, VolumeOf(*options.region)) : voxels;
    return options.shard ? delivered / options.shard->count : delivered;
  }
  return SumOver(mesh, [&](const Corners& corners) {
    return TwiceAreaOf(corners) / (size * size) + 2 * LengthAround(corners) / size + 1;
  });
}

double EstimateVisits(const TriangleMesh& mesh, const Grid& grid, const VoxelizeOptions& options) {
  if (options.algorithm != Algorithm::kBruteForce) return EstimateVoxels(mesh, grid, options);
  const double size = grid.lattice.voxel_size();
  return SumOver(mesh, [&](const Corners& corners) { return VolumeAround(corners, size); });
}

}  // namespace latvox
