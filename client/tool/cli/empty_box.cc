#include "client/tool/cli/empty_box.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/tool/output/vec3.h"

namespace latvox::client {
namespace {

template <class Box>
std::string Corners(const Box& box) {
  return absl::StrCat(absl::StrJoin(box.min, ","), ",", absl::StrJoin(box.max, ","));
}

int32_t ToIndex(double x) {
  constexpr double kMost = std::numeric_limits<int32_t>::max();
  return static_cast<int32_t>(std::clamp(x, -kMost, kMost));
}

// Returns the box of lattice points around a world box: its corners, rounded outward.
IndexBox IndexBoxOf(const WorldBox& box, const GridTransform& grid) {
  const Basis dual = Dual(grid.basis);
  const std::array<Vec3d, 3> axes = {dual.a, dual.b, dual.c};
  IndexBox around;
  for (size_t m = 0; m < 3; ++m) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (size_t corner = 0; corner < 8; ++corner) {
      Vec3d offset;
      for (size_t n = 0; n < 3; ++n) offset[n] = ((corner >> n & 1) != 0 ? box.max : box.min)[n] - grid.origin[n];
      const double index = Dot(offset, axes[m]);
      low = std::min(low, index);
      high = std::max(high, index);
    }
    around.min[m] = ToIndex(std::floor(low));
    around.max[m] = ToIndex(std::ceil(high) + 1);
  }
  return around;
}

}  // namespace

std::string EmptyBoxLine(const VoxelizeRequest& request, const Accepted& accepted) {
  const WorldBox mesh{accepted.mesh.min, accepted.mesh.max};
  std::vector<std::string> words;
  if (request.region) {
    const std::string around = Corners(IndexBoxOf(mesh, accepted.grid));
    words.push_back(absl::StrCat("--region ", Corners(*request.region), " (the mesh lies about in ", around, ")"));
  }
  if (request.bounds) {
    words.push_back(absl::StrCat("--bounds ", Corners(*request.bounds), " (the mesh lies in ", Corners(mesh), ")"));
  }
  return words.empty() ? "" : absl::StrCat("no voxel lies in ", absl::StrJoin(words, " and in "));
}

}  // namespace latvox::client
