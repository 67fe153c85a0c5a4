#include "client/python/files.h"

#include <memory>
#include <optional>
#include <utility>

#include "client/python/arguments.h"
#include "client/python/status.h"
#include "client/python/work.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/convert_command.h"
#include "client/tool/cli/info_json.h"
#include "client/tool/cli/merge_command.h"
#include "client/tool/cli/progress_bar.h"
#include "latvox/grid/carried_names.h"

namespace latvox::client::python {

namespace py = pybind11;

SharedVoxels OpenFile(const std::string& path) {
  if (const std::string wrong = CheckIsHere(path); !wrong.empty()) {
    Check(ToStatus(UsageError("path: " + wrong, {"path", path, ""})));
  }
  const SharedVoxels voxels = std::make_shared<Voxels>();
  RunOnFiles([&](Work& work) {
    auto file = ReadVoxelFile(path, std::nullopt, work.cancellation());
    if (!file.ok()) return file.status();
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
  RunOnFiles([&](Work& work) { return RunConvert(options, work.cancellation(), warnings).status(); });
  return ListOf(warnings);
}

std::string Merge(const std::vector<std::string>& parts, const std::string& out) {
  const MergeWords words = Checked(ParseMergeWords(parts, out));
  HideProgress();  // the tool's, which would be on the terminal
  std::string report;
  RunOnFiles([&](Work& work) {
    auto merged = RunMerge(words, work.cancellation());
    if (merged.ok()) report = *std::move(merged);
    return merged.status();
  });
  return report;
}

}  // namespace latvox::client::python
