// The options of a request: rows of the table that `latvox voxelize` and a line of `latvox batch` share.
#ifndef LATVOX_CLIENT_TOOL_CLI_REQUEST_ROWS_H_
#define LATVOX_CLIENT_TOOL_CLI_REQUEST_ROWS_H_

#include "client/tool/cli/voxelize_options.h"
#include "deploy/manual/command_parser.h"

namespace latvox::client {

// Adds the options of outputs, request and mesh, except mesh paths and server. Parsing checks each option alone, and
// pairs of options that exclude each other.
void AddRequestOptions(CommandParser& command, VoxelizeWords& words);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_REQUEST_ROWS_H_
