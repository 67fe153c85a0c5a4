#include "server/listen/shares.h"

#include <oneapi/tbb/info.h>

#include <algorithm>
#include <cstdint>

#include "absl/strings/str_cat.h"
#include "server/base/control_group.h"
#include "server/decode/decoder_process.h"
#include "server/work/memory_budget.h"

namespace latvox {
namespace {

// The most for kept meshes, and the process's other needs besides jobs.
constexpr uint64_t kStoreShare = 8;
constexpr uint64_t kOwnBytes = uint64_t{128} << 20;
constexpr uint64_t kLeastForJobs = uint64_t{64} << 20;
static_assert(kLeastMemoryBudget - kLeastMemoryBudget / kGrpcShare - kLeastMemoryBudget / kStoreShare >=
              kOwnBytes + kLeastForJobs);

uint64_t DefaultMemoryOf(const ServerOptions& options) {
  return options.shares_memory ? SharedMemoryBudget(DefaultMemoryBudget()) : DefaultMemoryBudget();
}

}  // namespace

absl::StatusOr<ServerOptions> WithMemoryShared(ServerOptions options) {
  const uint64_t all = options.memory_bytes == 0 ? DefaultMemoryOf(options) : options.memory_bytes;
  options.limits.mesh_store_bytes = std::min(options.limits.mesh_store_bytes, all / kStoreShare);
  const uint64_t taken = kOwnBytes + all / kGrpcShare + options.limits.mesh_store_bytes;
  if (all < taken + kLeastForJobs) {
    return absl::InvalidArgumentError(absl::StrCat("--memory-budget: ", all, " bytes leave less than ", kLeastForJobs,
                                                   " for jobs; ", kLeastMemoryBudget, " suffice"));
  }
  options.memory_bytes = all;
  options.limits.memory_budget_bytes = all - taken;
  return options;
}

// The control groups would stop more threads than their share of the cores, all together for a part of each period.
int ThreadsOf(const ServerOptions& options) {
  if (options.threads > 0) return options.threads;
  const int cores = oneapi::tbb::info::default_concurrency(), share = LimitsOfControlGroups().cores;
  return share == 0 ? cores : std::min(cores, share);
}

// As many decoder processes as compute threads, but not many, because one thread receives their meshes. At least two,
// so that a large mesh does not keep small ones waiting. Each may take the memory of the largest mesh. All together may
// take no more than a third of the default memory budget.
DecoderOptions DecodersOf(const ServerOptions& options) {
  constexpr int kMostProcesses = 4;
  DecoderOptions decoder = options.decoder;
  if (decoder.processes == 0) decoder.processes = std::clamp(ThreadsOf(options), 2, kMostProcesses);
  if (decoder.memory == 0) {
    const uint64_t needed = options.limits.max_mesh_bytes + kDecoderBytesPerTriangle * options.limits.max_triangles;
    decoder.memory = std::min(needed, DefaultMemoryOf(options) / 3 / static_cast<uint64_t>(decoder.processes));
  }
  return decoder;
}

}  // namespace latvox
