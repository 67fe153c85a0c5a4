#include "client/tool/cli/few_voxels.h"

#include <algorithm>

#include "absl/strings/str_format.h"

namespace latvox::client {

std::string FewVoxelsLine(const VoxelizeRequest& request, const Accepted& accepted) {
  constexpr double kFew = 4;
  double side = 0;
  for (size_t m = 0; m < 3; ++m) side = std::max(side, accepted.mesh.max[m] - accepted.mesh.min[m]);
  if (request.resolution || side >= kFew * accepted.grid.voxel_size) return "";
  return absl::StrFormat(
      "the mesh is small: its longest side, %g, is below %g voxel sizes of %g; --scale changes its unit", side, kFew,
      accepted.grid.voxel_size);
}

}  // namespace latvox::client
