// The edges of a cell's facets.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_FACET_RIMS_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_FACET_RIMS_H_

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "client/internal/vec3.h"
#include "client/tool/output/voxel_scene.h"

namespace latvox::client {

class FacetRims {
 public:
  explicit FacetRims(const std::vector<VoxelScene::Facet>& facets) {
    for (const VoxelScene::Facet& facet : facets) {
      std::vector<Rim>& rims = rims_.emplace_back();
      for (const VoxelScene::Facet& other : facets) {
        const double cosine = Dot(facet.normal, other.normal), sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
        if (sine > 1e-6) rims.push_back({other.distance / sine, Sum({}, 1 / sine, other.normal)});
      }
    }
  }

  // Returns the distance of a point on the facet from the nearest plane of another facet. The point is relative to the
  // center of the cell.
  double Distance(const Vec3d& at, int facet) const {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Rim& rim : rims_[static_cast<size_t>(facet)]) {
      nearest = std::min(nearest, rim.base - Dot(at, rim.slope));
    }
    return nearest;
  }

 private:
  struct Rim {
    double base;
    Vec3d slope;
  };

  std::vector<std::vector<Rim>> rims_;  // for each facet
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_FACET_RIMS_H_
