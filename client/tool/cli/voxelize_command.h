// `latvox voxelize`.
#ifndef LATVOX_CLIENT_TOOL_CLI_VOXELIZE_COMMAND_H_
#define LATVOX_CLIENT_TOOL_CLI_VOXELIZE_COMMAND_H_

#include <cstdint>
#include <functional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/tool/cli/report.h"
#include "client/tool/cli/voxelize_options.h"
#include "latvox/cancellation.h"
#include "latvox/client.h"

namespace latvox::client {

// Takes lattice and origin from the file that is to be aligned with, if there is one. Errors: those of reading it, with
// the field before the path.
absl::Status Align(VoxelizeOptions& options);

// What a job needs from the command that it is part of. Called on the job's thread.
struct JobHooks {
  std::function<absl::StatusOr<const Client*>()>
      connect;  // once, when the mesh is ready; valid until the job has ended
  std::function<void(const std::string& stage)> on_stage;  // what it begins with
  std::function<void(double share, uint64_t bricks)> on_progress;
  std::function<void(const std::string& line)> say;  // for people
};

// Reads and encodes the mesh, has it voxelized and writes every output. The outputs appear only if everything
// succeeded; otherwise files that exist stay as they are and nothing else is left. Of the options, those of the server
// and --json do not count.
absl::StatusOr<VoxelizeReport> RunJob(const VoxelizeOptions& options, const CallOptions& call, const JobHooks& hooks);

// The same with a server of its own choice, and a progress bar; aligned before.
absl::StatusOr<VoxelizeReport> RunVoxelize(const VoxelizeOptions& options, const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_VOXELIZE_COMMAND_H_
