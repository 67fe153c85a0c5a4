// Chooses the jobs of this worker when several workers share a list.
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

// Returns whether this worker runs the job, counted from 0. Workers take every count-th job, because neighbors in a
// list often cost the same.
inline bool DoesJob(const Worker& worker, uint64_t job) { return job % worker.count == worker.index; }

struct ChosenWorker {
  Worker worker;
  std::string source;  // the option or variables that chose the worker; empty: one worker runs everything
};

// Returns the worker that --worker names, otherwise the one that the variables of the engine name:
//   Kubernetes, an Indexed Job   JOB_COMPLETION_INDEX. LATVOX_WORKER_COUNT has the number of workers, because
//                                Kubernetes does not set one.
//   Slurm, a job array           SLURM_ARRAY_TASK_ID, counted from _MIN in steps of _STEP, of SLURM_ARRAY_TASK_COUNT.
// Throws UsageError naming variable, value and limit: one variable without the other, an index not below the count,
// both engines at once.
ChosenWorker ChooseWorker(const std::string& given);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_WORKER_H_
