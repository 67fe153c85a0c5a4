#include "client/tool/cli/worker.h"

#include <cstdlib>
#include <optional>

#include "absl/strings/str_cat.h"
#include "client/tool/cli/common_options.h"

namespace latvox::client {
namespace {

constexpr char kKubernetesIndex[] = "JOB_COMPLETION_INDEX", kCount[] = "LATVOX_WORKER_COUNT";
constexpr char kSlurmId[] = "SLURM_ARRAY_TASK_ID", kSlurmCount[] = "SLURM_ARRAY_TASK_COUNT";
constexpr char kSlurmMin[] = "SLURM_ARRAY_TASK_MIN", kSlurmStep[] = "SLURM_ARRAY_TASK_STEP";

// An empty variable counts as unset.
std::optional<uint32_t> Variable(const char* name) {
  const char* const text = std::getenv(name);
  if (text == nullptr || *text == '\0') return std::nullopt;
  uint32_t number = 0;
  if (!ParseNumber(text, number)) Refuse(name, ": \"", text, "\" is not a whole number from 0 to ", UINT32_MAX);
  return number;
}

uint32_t Needed(const char* name, const char* because) {
  const std::optional<uint32_t> number = Variable(name);
  if (!number) Refuse(because, " is set, but ", name, " is not; give both, or --worker I/N");
  return *number;
}

Worker Below(uint32_t index, uint32_t count, const std::string& sources) {
  if (count > kMaxShards) Refuse(sources, ": the count, ", count, ", exceeds ", kMaxShards);
  if (index >= count) Refuse(sources, ": worker ", index, " is not below the count, ", count);
  return {index, count};
}

ChosenWorker FromKubernetes(uint32_t index) {
  const std::string sources = absl::StrCat(kKubernetesIndex, ", ", kCount);
  return {Below(index, Needed(kCount, kKubernetesIndex), sources), sources};
}

ChosenWorker FromSlurm(uint32_t id) {
  const uint32_t count = Needed(kSlurmCount, kSlurmId), min = Needed(kSlurmMin, kSlurmId);
  const uint32_t step = Variable(kSlurmStep).value_or(1);
  if (id < min || step == 0 || (id - min) % step != 0) {
    Refuse(kSlurmId, ": ", id, " is not ", min, " (", kSlurmMin, ") plus a multiple of ", step);
  }
  const std::string sources = absl::StrCat(kSlurmId, ", ", kSlurmCount);
  return {Below((id - min) / step, count, sources), sources};
}

}  // namespace

ChosenWorker ChooseWorker(const std::string& given) {
  if (const auto worker = ParseShard(given)) return {{worker->index, worker->count}, "--worker"};
  const std::optional<uint32_t> kubernetes = Variable(kKubernetesIndex), slurm = Variable(kSlurmId);
  if (kubernetes && slurm) Refuse(kKubernetesIndex, " and ", kSlurmId, " are both set; choose with --worker I/N");
  if (kubernetes) return FromKubernetes(*kubernetes);
  if (slurm) return FromSlurm(*slurm);
  // With a count but no index, every worker would run all jobs.
  if (Variable(kCount)) Refuse(kCount, " is set, but ", kKubernetesIndex, " is not; give both, or --worker I/N");
  return {};
}

}  // namespace latvox::client
