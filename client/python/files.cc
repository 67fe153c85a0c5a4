#include "client/python/files.h"

#include <memory>
#include <optional>
#include <utility>

#include "client/internal/file_error.h"
#include "client/python/arguments.h"
#include "client/python/status.h"
#include "client/python/work.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/convert_command.h"
#include "client/tool/cli/info_json.h"
#include "client/tool/cli/merge_command.h"
#include "client/tool/cli/progress_bar.h"
#include "client/tool/output/output.h"
#include "latvox/grid/carried_names.h"

namespace latvox::client::python {

namespace py = pybind11;

namespace {

// Returns the formats of files that can be read, if this one is wrong because it has another.
std::string LimitOf(const absl::Status& error, const std::string& path) {
  return absl::IsInvalidArgument(error) && !HasExtension(path, {".vdb", ".nvdb"}) ? ".vdb .nvdb" : "";
}

}  // namespace

SharedVoxels OpenFile(const std::string& path) {
  if (const std::string wrong = CheckIsHere(path); !wrong.empty()) {
    Check(ToStatus(UsageError("path: " + wrong, {"path", path, ""})));
  }
  const SharedVoxels voxels = std::make_shared<Voxels>();
  RunOnFiles([&](Work& work) {
    auto file = ReadVoxelFile(path, std::nullopt, work.cancellation());
    if (!file.ok()) return WithFile(file.status(), "path", path, LimitOf(file.status(), path));
    const GridFileInfo& info = file->content.file.info;
    voxels->report = ToJson(info);
    voxels->names = ReadCarriedNames(info);
    voxels->request = std::move(file->request);
    voxels->output_options = std::move(file->output_options);
    voxels->all.accepted = std::move(file->accepted);
    voxels->all.bricks = std::move(file->content.file.bricks);
    voxels->all.fields = std::move(file->content.fields);
    voxels->all.summary = std::move(file->summary);
    return absl::OkStatus();
  });
  return voxels;
}

py::list Convert(const std::string& path, const py::dict& keywords) {
  const ConvertOptions options = Checked(ParseConvertKeywords(keywords, path));
  std::vector<Warning> warnings;
  RunOnFiles([&](Work& work) {
    const absl::Status status = RunConvert(options, work.cancellation(), warnings).status();
    return WithFile(status, "path", options.input, LimitOf(status, options.input));
  });
  return ListOf(warnings);
}

std::string Merge(const std::vector<std::string>& parts, const std::string& out) {
  const MergeWords words = Checked(ParseMergeWords(parts, out));
  HideProgress();  // the tool's, which would be on the terminal
  std::string report;
  RunOnFiles([&](Work& work) {
    auto merged = RunMerge(words, work.cancellation());
    if (merged.ok()) report = *std::move(merged);
    absl::Status status = merged.status();
    for (const std::string& part : words.parts) status = WithFile(status, "parts", part);
    return status;
  });
  return report;
}

}  // namespace latvox::client::python
