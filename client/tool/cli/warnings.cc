#include "client/tool/cli/warnings.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/tool/cli/common_options.h"

namespace latvox::client {
namespace {

// Shards may be empty, and then the whole lacks nothing.
bool IsNote(const Warning& warning) { return warning.code == "EMPTY_SHARD"; }

}  // namespace

absl::Status Warn(const std::vector<Warning>& warnings, bool strict,
                  const std::function<void(const std::string& line)>& say) {
  std::vector<std::string> codes;
  for (const Warning& warning : warnings) {
    say(absl::StrCat(IsNote(warning) ? "note: " : "warning: ", warning.message));
    if (!IsNote(warning)) codes.push_back(warning.code);
  }
  if (!strict || codes.empty()) return absl::OkStatus();
  const std::string given = absl::StrJoin(codes, ", ");
  return ToStatus(
      UsageError(absl::StrCat("--strict: no warning is allowed, and there is ", given), {"--strict", given}));
}

std::optional<Warning> WarningOfSize(const Accepted& accepted, const VoxelizeRequest& request) {
  constexpr double kMany = 20000;
  if (request.resolution || request.region || request.bounds || request.shard) return std::nullopt;
  double voxels = 0;
  for (size_t m = 0; m < 3; ++m) {
    voxels = std::max(voxels, (accepted.mesh.max[m] - accepted.mesh.min[m]) / accepted.grid.voxel_size);
  }
  if (voxels <= kMany) return std::nullopt;
  return Warning{"MANY_VOXELS",
                 absl::StrCat("the mesh is ", std::llround(voxels),
                              " voxels long, and may have billions of them; if its "
                              "unit is another one, --scale converts it"),
                 "voxel_size"};
}

}  // namespace latvox::client
