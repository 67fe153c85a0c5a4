// Which jobs of a list are this worker's, when several workers share it.
#ifndef LATVOX_CLIENT_TOOL_CLI_LINE_SHARD_H_
#define LATVOX_CLIENT_TOOL_CLI_LINE_SHARD_H_

#include <cstdint>
#include <string>

#include "latvox/types.h"

namespace latvox::client {

// Whether the job, counted from 0 on, is that of this one of `count` workers. Neighbours in a list are often alike, so
// that jobs are dealt out one by one.
inline bool Takes(const Shard& shard, uint64_t job) { return job % shard.count == shard.index; }

struct ChosenShard {
  Shard shard;
  std::string source;  // the option or the variables that say so; empty: nothing does, and it is the whole
};

// What --shard says; if that is empty, what the engine's variables say:
//   Kubernetes, an Indexed Job   JOB_COMPLETION_INDEX; the number of workers is LATVOX_SHARD_COUNT, as it gives none
//   Slurm, a job array           SLURM_ARRAY_TASK_ID, counted from _MIN on in steps of _STEP, of SLURM_ARRAY_TASK_COUNT
// Throws CLI::ValidationError, naming variable, value and limit: a part without the other, not below the count, both
// engines at once.
ChosenShard ChooseShard(const std::string& given);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_LINE_SHARD_H_
