#include "client/tool/output/outputs.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

namespace latvox::client {

absl::Status ForAllAtOnce(const Outputs& outputs, const Cancellation& cancellation,
                          const std::function<absl::Status(Output&)>& step) {
  std::vector<absl::Status> ends(outputs.size());
  tbb::parallel_for(size_t{0}, outputs.size(), [&](size_t n) {
    if (cancellation.cancelled()) {
      ends[n] = absl::CancelledError("cancelled");
      return;
    }
    // An output that waits for its own tasks would otherwise begin another output in the meantime, with its locks held.
    tbb::this_task_arena::isolate([&] { ends[n] = step(*outputs[n]); });
  });
  for (const absl::Status& end : ends) {
    if (!end.ok()) return end;
  }
  return absl::OkStatus();
}

absl::Status CommitAll(const Outputs& outputs) {
  for (const auto& output : outputs) {
    if (auto status = output->Commit(); !status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace latvox::client
