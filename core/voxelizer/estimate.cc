#include "core/voxelizer/estimate.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace latvox {
namespace {

double TwiceAreaOf(const TriangleMesh& mesh, const std::array<uint32_t, 3>& triangle) {
  const auto& [a, b, c] = triangle;
  const Vec3f &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
  Vec3d u, v;
  for (size_t m = 0; m < 3; ++m) {
    u[m] = double{q[m]} - double{p[m]};
    v[m] = double{r[m]} - double{p[m]};
  }
  const Vec3d normal = Cross(u, v);
  return std::sqrt(Dot(normal, normal));
}

double AreaOf(const TriangleMesh& mesh) {
  using Part = oneapi::tbb::blocked_range<size_t>;
  constexpr size_t kGrain = 16384;  // triangles a task
  const double twice = oneapi::tbb::parallel_deterministic_reduce(
      Part(0, mesh.triangles.size(), kGrain), 0.0,
      [&](const Part& part, double sum) {
        for (size_t t = part.begin(); t < part.end(); ++t) sum += TwiceAreaOf(mesh, mesh.triangles[t]);
        return sum;
      },
      std::plus<>());
  return twice / 2;
}

double VolumeOf(const IndexBox& box) {
  double volume = 1;
  for (size_t m = 0; m < 3; ++m)
    volume *= std::max(0.0, static_cast<double>(box.max[m]) - static_cast<double>(box.min[m]));
  return volume;
}

}  // namespace

double EstimateVoxels(const TriangleMesh& mesh, const Grid& grid, const VoxelizeOptions& options) {
  const double voxel_size = grid.lattice.voxel_size();
  const double voxels = 2 * AreaOf(mesh) / (voxel_size * voxel_size);
  return options.region ? std::min(voxels, VolumeOf(*options.region)) : voxels;
}

}  // namespace latvox
