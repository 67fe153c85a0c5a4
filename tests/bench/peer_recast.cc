#include <recastnavigation/Recast.h>

#include <array>
#include <cmath>
#include <vector>

#include "absl/strings/str_cat.h"
#include "tests/bench/peer.h"

namespace latvox {
namespace {

// The lattice's axes in the order of Recast's, whose columns run along the second one: here along the mesh's shortest
// side, because Recast is made for landscapes.
std::array<size_t, 3> AxesOf(const Bounds& bounds) {
  size_t up = 0;
  for (const size_t m : {1, 2}) {
    if (bounds.max[m] - bounds.min[m] < bounds.max[up] - bounds.min[up]) up = m;
  }
  return {(up + 1) % 3, up, (up + 2) % 3};
}

struct FreeHeightfield {
  void operator()(rcHeightfield* field) const { rcFreeHeightField(field); }
};

class Recast : public Peer {
 public:
  // `axes` and `cells` are in Recast's order.
  Recast(const TriangleMesh& mesh, const Bounds& bounds, double voxel_size, const std::array<size_t, 3>& axes,
         const std::array<int, 3>& cells)
      : cells_(cells) {
    for (const Vec3f& p : mesh.vertices) {
      for (const size_t m : axes) points_.push_back(static_cast<float>((p[m] - bounds.min[m]) / voxel_size));
    }
    for (const auto& t : mesh.triangles) {
      for (const uint32_t corner : t) corners_.push_back(static_cast<int>(corner));
    }
    areas_.resize(mesh.triangles.size(), RC_WALKABLE_AREA);
  }

  absl::Status Run() override {
    constexpr std::array<float, 3> low{};
    std::array<float, 3> high;
    for (size_t m = 0; m < 3; ++m) high[m] = static_cast<float>(cells_[m]);
    field_.reset(rcAllocHeightfield());
    if (!rcCreateHeightfield(&context_, *field_, cells_[0], cells_[2], low.data(), high.data(), 1, 1) ||
        !rcRasterizeTriangles(&context_, points_.data(), static_cast<int>(points_.size() / 3), corners_.data(),
                              areas_.data(), static_cast<int>(areas_.size()), *field_)) {
      return absl::ResourceExhaustedError("--peer recast: Recast has too little memory for its heightfield");
    }
    return absl::OkStatus();
  }

  uint64_t Finish() override {
    uint64_t voxels = 0;
    const size_t columns = static_cast<size_t>(field_->width) * static_cast<size_t>(field_->height);
    for (size_t n = 0; n < columns; ++n) {
      for (const rcSpan* span = field_->spans[n]; span != nullptr; span = span->next) voxels += span->smax - span->smin;
    }
    field_.reset();
    return voxels;
  }

 private:
  const std::array<int, 3> cells_;
  std::vector<float> points_;
  std::vector<int> corners_;
  std::vector<unsigned char> areas_;
  rcContext context_{false};  // without logs and timers
  std::unique_ptr<rcHeightfield, FreeHeightfield> field_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Peer>> RecastPeer(const TriangleMesh& mesh, const Bounds& bounds, double voxel_size) {
  const std::array<size_t, 3> axes = AxesOf(bounds);
  std::array<int, 3> cells;
  for (size_t m = 0; m < 3; ++m) {
    const double length = bounds.max[axes[m]] - bounds.min[axes[m]];
    cells[m] = static_cast<int>(std::floor(length / voxel_size)) + 1;
  }
  if (cells[1] > RC_SPAN_MAX_HEIGHT) {
    return absl::InvalidArgumentError(absl::StrCat("--peer recast: the mesh has ", cells[1],
                                                   " voxels along its shortest side; Recast's limit is ",
                                                   RC_SPAN_MAX_HEIGHT));
  }
  return std::make_unique<Recast>(mesh, bounds, voxel_size, axes, cells);
}

}  // namespace latvox
