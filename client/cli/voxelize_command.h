// `latvox voxelize`.
#ifndef LATVOX_CLIENT_CLI_VOXELIZE_COMMAND_H_
#define LATVOX_CLIENT_CLI_VOXELIZE_COMMAND_H_

#include "absl/status/statusor.h"
#include "client/cancellation.h"
#include "client/cli/report.h"
#include "client/cli/voxelize_options.h"

namespace latvox::client {

// Reads and encodes the mesh, has it voxelized and writes every output. The outputs appear only if everything
// succeeded; otherwise files that exist stay as they are and nothing else is left.
absl::StatusOr<VoxelizeReport> RunVoxelize(const VoxelizeOptions& options, const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_CLI_VOXELIZE_COMMAND_H_
