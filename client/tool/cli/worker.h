// Which jobs of a list are this worker's, when several workers share it.
#ifndef LATVOX_CLIENT_TOOL_CLI_WORKER_H_
#define LATVOX_CLIENT_TOOL_CLI_WORKER_H_

#include <cstdint>
#include <string>

namespace latvox::client {

// One of `count` workers.
struct Worker {
  uint32_t index = 0, count = 1;
  bool operator==(const Worker&) const = default;
};

// Whether the job, counted from 0 on, is that of this worker. Neighbours in a list are often alike, so that jobs are
// dealt out one by one.
inline bool DoesJob(const Worker& worker, uint64_t job) { return job % worker.count == worker.index; }

struct ChosenWorker {
  Worker worker;
  std::string source;  // the option or the variables that say so; empty: nothing does, and one worker does the whole
};

// What --worker says; if that is empty, what the engine's variables say:
//   Kubernetes, an Indexed Job   JOB_COMPLETION_INDEX; the number of workers is LATVOX_WORKER_COUNT, as it gives none
//   Slurm, a job array           SLURM_ARRAY_TASK_ID, counted from _MIN on in steps of _STEP, of SLURM_ARRAY_TASK_COUNT
// Throws UsageError, naming variable, value and limit: a part without the other, not below the count, both engines at
// once.
ChosenWorker ChooseWorker(const std::string& given);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_WORKER_H_
