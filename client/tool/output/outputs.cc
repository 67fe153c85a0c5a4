#include "client/tool/output/outputs.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cstdint>
#include <new>

#include "deploy/process/exhaustion.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
absl::Status ForAllAtOnce(const Outputs& outputs, const Cancellation& cancellation,
                          const std::function<absl::Status(Output&)>& step) {
  std::vector<absl::Status> ends(outputs.size());
  const auto run = [&](size_t n) {
    try {
      ends[n] = cancellation.cancelled() ? absl::CancelledError("cancelled by the caller") : step(*outputs[n]);
    } catch (const std::bad_alloc&) {
      ends[n] = absl::ResourceExhaustedError("not enough memory");
    }
  };
  if (outputs.size() < 2 || !HasAddressesForThreads()) {
    for (size_t n = 0; n < outputs.size(); ++n) run(n);
  } else {
    // Isolated: an output that waits for its own tasks would otherwise begin another output in the meantime, with its
    // locks held.
    tbb::parallel_for(size_t{0}, outputs.size(), [&](size_t n) { tbb::this_task_arena::isolate([&] { run(n); }); });
  }
  for (const absl::Status& end : ends) {
    if (!end.ok()) return end;
  }
  return absl::OkStatus();
}

absl::Status AddInPieces(const BrickBatch& all, const Cancellation& cancellation,
                         absl::FunctionRef<absl::Status(const BrickBatch&)> add) {
  constexpr size_t kBricks = 256;
  size_t first = 0;  // of the piece's voxels
  for (size_t brick = 0; brick < all.bricks.size(); brick += kBricks) {
    if (cancellation.cancelled()) return absl::CancelledError("cancelled");
    const auto bricks = all.bricks.subspan(brick, std::min(kBricks, all.bricks.size() - brick));
    size_t count = 0;
    for (const Brick& one : bricks) count += CountVoxels(one);
    std::vector<FieldValues> fields;
    for (const FieldValues& values : all.fields) {
      const std::byte* const begin = values.bytes.data() + first * values.bytes_of_voxel();
      fields.push_back(
          {values.field, {begin, begin + count * values.bytes_of_voxel()}, values.neighbors, values.labels});
    }
    if (auto status = add({bricks, all.progress, fields}); !status.ok()) return status;
    first += count;
  }
  return absl::OkStatus();
}

std::vector<Warning> WarningsOf(const Outputs& outputs) {
  std::vector<Warning> all;
  for (const auto& output : outputs) {
    for (Warning& warning : output->Warnings()) all.push_back(std::move(warning));
  }
  return all;
}

absl::Status CommitAll(const Outputs& outputs) {
  for (const auto& output : outputs) {
    if (auto status = output->Commit(); !status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace latvox::client
