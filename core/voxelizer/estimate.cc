#include "core/voxelizer/estimate.h"

#include <algorithm>
#include <cmath>

namespace latvox {
namespace {

double AreaOf(const TriangleMesh& mesh) {
  double twice = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3f &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    Vec3d u, v;
    for (size_t m = 0; m < 3; ++m) {
      u[m] = double{q[m]} - double{p[m]};
      v[m] = double{r[m]} - double{p[m]};
    }
    const Vec3d normal = Cross(u, v);
    twice += std::sqrt(Dot(normal, normal));
  }
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
