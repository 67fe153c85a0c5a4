#include "client/tool/cli/merge_command.h"

#include <sys/resource.h>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/grid_input.h"
#include "client/tool/cli/progress_bar.h"
#include "client/tool/cli/report.h"
#include "client/tool/output/atomic_file.h"
#include "client/tool/vdb/vdb.h"

namespace latvox::client {
namespace {

void AllowManyOpenFiles() {
  rlimit files{};
  if (getrlimit(RLIMIT_NOFILE, &files) != 0) return;
  files.rlim_cur = files.rlim_max;
  setrlimit(RLIMIT_NOFILE, &files);  // on failure, opening one file too many reports the error
}

}  // namespace

void AddMergeOptions(CommandParser& command, MergeWords& words) {
  command.Add({{.names = "parts",
                .target = &words.parts,
                .help = "Parts of one mesh and request: .vdb or .nvdb files made with --region, --bounds or --shard",
                .value = "PART.vdb",
                .checks = {{CheckIsHere}},
                .required = true},
               OutputRow({".vdb"}, words.outputs, /*several=*/false, "; latvox convert writes it in other formats"),
               JsonRow("Print the summary as JSON", words.json)});
}

void Check(const MergeWords& words) {
  if (words.outputs.size() != 1) Refuse("--out: one file, not ", words.outputs.size());
  for (const std::string& part : words.parts) CheckOutputs(words.outputs, part, "part");
}

absl::StatusOr<std::string> RunMerge(const MergeWords& words, const Cancellation& cancellation) {
  const absl::Time start = absl::Now();
  AllowManyOpenFiles();
  const std::string& output = words.outputs.front();
  const auto vdb = Vdb::Load();
  if (!vdb.ok()) return vdb.status();
  auto file = AtomicFile::Create(output);
  if (!file.ok()) return file.status();
  ProgressBar bar;
  bar.Stage("merging");
  const auto merged = (*vdb)->Merge(
      words.parts, (*file)->temporary(), cancellation,
      [&bar](double share, uint64_t bricks) { bar.Show(share, "bricks", bricks); },
      [&cancellation](const std::string& path) { return ReadInputContent(path, /*values=*/true, cancellation); });
  if (!merged.ok()) return (*file)->Named(merged.status());
  if (auto status = (*file)->Sync(); !status.ok()) return status;
  if (cancellation.cancelled()) return absl::CancelledError("cancelled");
  if (auto status = (*file)->Commit(); !status.ok()) return status;
  const MergeReport report{words.parts.size(), output, *merged, absl::ToDoubleMilliseconds(absl::Now() - start)};
  return words.json ? ToJson(report) + "\n" : ToText(report);
}

}  // namespace latvox::client
