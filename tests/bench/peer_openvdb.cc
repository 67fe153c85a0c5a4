#include "tests/bench/peer_openvdb.h"

#include <openvdb/tools/MeshToVolume.h>

#include <vector>

namespace latvox {

struct OpenVdbPeer::Data {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
};

OpenVdbPeer::OpenVdbPeer(const TriangleMesh& mesh, const Bounds& bounds, double voxel_size) : data_(new Data) {
  openvdb::initialize();
  for (const Vec3f& p : mesh.vertices) {
    openvdb::Vec3s point;
    for (int m = 0; m < 3; ++m) {
      const auto axis = static_cast<size_t>(m);
      point[m] = static_cast<float>((p[axis] - bounds.min[axis]) / voxel_size);
    }
    data_->points.push_back(point);
  }
  for (const auto& t : mesh.triangles) data_->triangles.emplace_back(t[0], t[1], t[2]);
}

OpenVdbPeer::~OpenVdbPeer() { delete data_; }

uint64_t OpenVdbPeer::Run(float band) const {
  using Mesh = openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I>;
  const Mesh mesh(data_->points.data(), data_->points.size(), data_->triangles.data(), data_->triangles.size());
  const openvdb::math::Transform transform;
  const auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(mesh, transform, band, band,
                                                                     openvdb::tools::UNSIGNED_DISTANCE_FIELD);
  return grid->activeVoxelCount();
}

}  // namespace latvox
