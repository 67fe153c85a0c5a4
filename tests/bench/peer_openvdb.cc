#include <openvdb/tools/MeshToVolume.h>

#include <vector>

#include "tests/bench/peer.h"

namespace latvox {
namespace {

class OpenVdb : public Peer {
 public:
  OpenVdb(const TriangleMesh& mesh, const Bounds& bounds, double voxel_size, float half_width)
      : half_width_(half_width) {
    openvdb::initialize();
    for (const Vec3f& p : mesh.vertices) {
      openvdb::Vec3s point;
      for (int m = 0; m < 3; ++m) {
        const auto axis = static_cast<size_t>(m);
        point[m] = static_cast<float>((p[axis] - bounds.min[axis]) / voxel_size);
      }
      points_.push_back(point);
    }
    for (const auto& t : mesh.triangles) triangles_.emplace_back(t[0], t[1], t[2]);
  }

  absl::Status Run() override {
    using Mesh = openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I>;
    const Mesh mesh(points_.data(), points_.size(), triangles_.data(), triangles_.size());
    const openvdb::math::Transform transform;
    grid_ = openvdb::tools::meshToVolume<openvdb::FloatGrid>(mesh, transform, half_width_, half_width_,
                                                             openvdb::tools::UNSIGNED_DISTANCE_FIELD);
    return absl::OkStatus();
  }

  uint64_t Finish() override {
    const uint64_t voxels = grid_->activeVoxelCount();
    grid_.reset();
    return voxels;
  }

 private:
  std::vector<openvdb::Vec3s> points_;
  std::vector<openvdb::Vec3I> triangles_;
  const float half_width_;
  openvdb::FloatGrid::Ptr grid_;
};

}  // namespace

std::unique_ptr<Peer> OpenVdbPeer(const TriangleMesh& mesh, const Bounds& bounds, double voxel_size, float half_width) {
  return std::make_unique<OpenVdb>(mesh, bounds, voxel_size, half_width);
}

}  // namespace latvox
