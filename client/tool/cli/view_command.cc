#include "client/tool/cli/view_command.h"

#include <filesystem>

#include "absl/strings/str_cat.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/grid_input.h"
#include "client/tool/output/atomic_file.h"
#include "client/tool/output/file_metadata.h"
#include "client/tool/view/page.h"
#include "latvox/grid/grid_content.h"

namespace latvox::client {
void AddViewOptions(CommandParser& command, ViewWords& words) {
  command.Add({GridFileRow(words.input),
               OutputRow({".html"}, words.outputs, /*several=*/false),
               {.names = "--view-up",
                .target = &words.view_up,
                .help = "Axis that points up",
                .words = WordsOf(UpNames()),
                .word_help = {"z points up", "x points up", "y points up"},
                .standard = "z if --up-axis turned the mesh, otherwise y"}});
}

void Check(const ViewWords& words) {
  if (words.outputs.size() != 1) Refuse("--out: one file, not ", words.outputs.size());
  CheckOutputs(words.outputs, words.input, "file");
}

absl::StatusOr<std::string> RunView(const ViewWords& words, const Cancellation& cancellation) {
  const std::string& output = words.outputs.front();
  const auto content = ReadInputContent(words.input, /*values=*/true, cancellation);
  if (!content.ok()) return content.status();
  const GridFileInfo& info = content->file.info;
  const UpAxis up = words.view_up.empty() ? UpOf(info) : ValueNamed(UpNames(), words.view_up);
  const auto page = ViewPage(*content, std::filesystem::path(words.input).filename().string(), up);
  if (!page.ok()) {
    return absl::Status(page.status().code(), absl::StrCat(words.input, ": ", page.status().message()));
  }
  if (cancellation.cancelled()) return absl::CancelledError("cancelled");
  if (auto status = WriteAtomically(output, *page); !status.ok()) return status;
  return absl::StrCat(words.input, ": ", info.active_voxels, " voxels\nwrote ", output, ", ", page->size(), " bytes\n");
}

}  // namespace latvox::client
