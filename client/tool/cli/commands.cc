#include "client/tool/cli/commands.h"

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/tool/cli/grid_input.h"
#include "client/tool/cli/info_json.h"
#include "client/tool/cli/report.h"
#include "client/tool/inspect/file_facts.h"
#include "client/tool/output/output.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {
namespace {

std::string NineDigits(const Vec3d& v) { return absl::StrFormat("%.9g %.9g %.9g", v[0], v[1], v[2]); }

std::string ToText(const GridFileInfo& info) {
  std::string text = absl::StrFormat("grid           %s (%s)\n", info.name, info.value_type);
  absl::StrAppendFormat(&text, "active voxels  %d\n", info.active_voxels);
  if (const auto& box = info.active_box) {
    absl::StrAppend(&text, "active box     ", absl::StrJoin(box->min, ","), " to below ", absl::StrJoin(box->max, ","),
                    "\n");
  } else {
    text += "active box     empty\n";
  }
  absl::StrAppendFormat(&text, "voxel size     %.9g\n", info.transform.voxel_size);
  absl::StrAppend(&text, "step in i      ", NineDigits(info.transform.basis.a), "\n");
  absl::StrAppend(&text, "step in j      ", NineDigits(info.transform.basis.b), "\n");
  absl::StrAppend(&text, "step in k      ", NineDigits(info.transform.basis.c), "\n");
  absl::StrAppend(&text, "origin         ", NineDigits(info.transform.origin), "\n");
  for (const auto& [name, value] : info.metadata) {
    // OpenVDB writes the empty box with the highest number as its minimum.
    const bool empty = info.active_voxels == 0 && absl::StartsWith(name, "file_bbox_");
    absl::StrAppendFormat(&text, "%s = %s\n", name, empty ? "empty" : value);
  }
  return text;
}

// The facts of a .nvdb need no process, unless they are compressed.
absl::StatusOr<GridFileInfo> ReadGridInfo(const std::string& path) {
  if (HasExtension(path, {".nvdb"})) {
    auto info = ReadNanoFileInfo(path);
    if (!absl::IsFailedPrecondition(info.status())) return info;
  }
  return ReadInputInfo(path);
}

}  // namespace

absl::StatusOr<std::string> RunInfo(const std::string& path, bool json) {
  if (HasExtension(path, {".vdb", ".nvdb", ".h5"})) {
    const auto info = ReadGridInfo(path);
    if (!info.ok()) return info.status();
    return json ? ToJson(*info) + "\n" : ToText(*info);
  }
  const auto facts = ReadFileFacts(path);
  if (!facts.ok()) return facts.status();
  return json ? facts->json + "\n" : facts->text;
}

absl::StatusOr<std::string> RunHealth(const ServerChoice& choice, const Cancellation& cancellation) {
  const CallOptions call = MakeCallOptions(choice, cancellation);
  const auto session = Session::Open(choice, call);
  if (!session.ok()) return session.status();
  const auto healthy = session->client().Health(call);
  if (!healthy.ok()) return healthy.status();
  if (!*healthy) return absl::UnavailableError("the server accepts no requests (NOT_SERVING)");
  return "SERVING\n";
}

absl::StatusOr<std::string> RunLimits(const ServerChoice& choice, bool json, const Cancellation& cancellation) {
  const CallOptions call = MakeCallOptions(choice, cancellation);
  const auto session = Session::Open(choice, call);
  if (!session.ok()) return session.status();
  const auto limits = session->client().GetLimits(call);
  if (!limits.ok()) return limits.status();
  return json ? ToJson(*limits) + "\n" : ToText(*limits);
}

}  // namespace latvox::client
