#include "client/cli/view_command.h"

#include <filesystem>

#include "absl/strings/str_cat.h"
#include "client/cli/common_options.h"
#include "client/grid/voxel_grid.h"
#include "client/output/atomic_file.h"
#include "client/view/page.h"

namespace latvox::client {

void AddViewOptions(CLI::App& command, ViewWords& words) {
  command.add_option("file", words.input, "a .vdb file")->type_name("IN.vdb")->required();
  AddOutputOption(command, {".html"}, words.outputs);
}

void Check(const ViewWords& words) {
  if (words.outputs.size() != 1) Refuse("--out: one file, not ", words.outputs.size());
  CheckOutputs(words.outputs, words.input, "file");
}

absl::StatusOr<std::string> RunView(const ViewWords& words, const Cancellation& cancellation) {
  const std::string& output = words.outputs.front();
  const auto file = ReadGridFile(words.input);
  if (!file.ok()) return file.status();
  const auto page = ViewPage(*file, std::filesystem::path(words.input).filename().string());
  if (!page.ok()) return page.status();
  if (cancellation.cancelled()) return absl::CancelledError("cancelled");
  if (auto status = WriteAtomically(output, *page); !status.ok()) return status;
  return absl::StrCat(words.input, ": ", file->info.active_voxels, " voxels\nwrote ", output, ", ", page->size(),
                      " bytes\n");
}

}  // namespace latvox::client
