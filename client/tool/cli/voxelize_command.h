// `latvox voxelize`.
#ifndef LATVOX_CLIENT_TOOL_CLI_VOXELIZE_COMMAND_H_
#define LATVOX_CLIENT_TOOL_CLI_VOXELIZE_COMMAND_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/tool/cli/mesh_upload.h"
#include "client/tool/cli/report.h"
#include "client/tool/cli/voxelize_options.h"
#include "client/tool/output/output.h"
#include "latvox/cancellation.h"
#include "latvox/client.h"
#include "latvox/warning.h"

namespace latvox::client {

// Takes lattice and origin from the file of --align, if one is given. Errors: those of reading it, with the field
// before the path.
absl::Status Align(VoxelizeOptions& options, const Cancellation& cancellation);

// Calls of a job to the command that runs it, on the thread of the job.
struct JobHooks {
  // Called once, when the mesh is ready. The client is valid until `disconnect`, or the end of the job.
  std::function<absl::StatusOr<const Client*>()> connect;
  std::function<void(const std::string& stage)> on_stage;  // called when a stage begins
  std::function<void(double share, uint64_t bricks)> on_progress;
  std::function<void(const std::string& line)> say;  // prints a line for people
  std::vector<Warning> warnings = {};                // of the command itself: the report begins with them
  MeshReader read_mesh = nullptr;                    // returns the mesh; null: reads the files of the options
  // Opens an output of the request; null: opens a file. Called again for an output that was closed.
  std::function<absl::StatusOr<std::unique_ptr<Output>>(const std::string& output, const VoxelizeRequest& request)>
      open_output = nullptr;
  // Returns what takes the voxels of the request besides the files.
  std::function<std::unique_ptr<Output>(const VoxelizeRequest& request)> receive = nullptr;
  // Called once the job needs the client no longer, while the outputs are still to be finished.
  std::function<void()> disconnect = nullptr;
};

// Reads and encodes the mesh, lets the server voxelize it and writes every output. The outputs appear only if
// everything succeeded. Otherwise existing files stay as they are, and nothing else is left. Ignores the options of the
// server and --json.
absl::StatusOr<VoxelizeReport> RunJob(const VoxelizeOptions& options, const CallOptions& call, const JobHooks& hooks);

// Aligns the options, chooses a server, and runs the job with a progress bar.
absl::StatusOr<VoxelizeReport> RunVoxelize(const VoxelizeOptions& options, const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_VOXELIZE_COMMAND_H_
