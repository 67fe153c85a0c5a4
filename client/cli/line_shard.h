// Which jobs of a list are this worker's, when several workers share it.
#ifndef LATVOX_CLIENT_CLI_LINE_SHARD_H_
#define LATVOX_CLIENT_CLI_LINE_SHARD_H_

#include <cstdint>
#include <string>

namespace latvox::client {

// Of `count` workers, the one with this index, from 0 on. Neighbours in a list are often alike, so that jobs are dealt
// out one by one.
struct LineShard {
  uint32_t index = 0, count = 1;
  bool Takes(uint64_t job) const { return job % count == index; }
  bool operator==(const LineShard&) const = default;
};

// "I/N" with 0 <= I < N. Returns what is wrong with the text, for CLI11; empty if nothing is.
std::string CheckShard(const std::string& text);

struct ChosenShard {
  LineShard shard;
  std::string
      source;  // what it comes from: names of an option or of variables; empty: nothing says, so it is the whole
};

// What --shard says; if that is empty, what the engine's variables say:
//   Kubernetes, an Indexed Job   JOB_COMPLETION_INDEX; the number of workers is LATVOX_SHARD_COUNT, as it gives none
//   Slurm, a job array           SLURM_ARRAY_TASK_ID, counted from _MIN on in steps of _STEP, of SLURM_ARRAY_TASK_COUNT
// Throws CLI::ValidationError, naming variable, value and limit: a part without the other, not below the count, both
// engines at once.
ChosenShard ChooseShard(const std::string& given);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_CLI_LINE_SHARD_H_
