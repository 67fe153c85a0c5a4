// The options that say what is asked for: rows of the table that `latvox voxelize` and a line of `latvox batch` share.
#ifndef LATVOX_CLIENT_TOOL_CLI_REQUEST_ROWS_H_
#define LATVOX_CLIENT_TOOL_CLI_REQUEST_ROWS_H_

#include <optional>

#include "absl/strings/string_view.h"
#include "client/tool/cli/voxelize_options.h"
#include "deploy/manual/command_parser.h"
#include "latvox/types.h"

namespace latvox::client {

// Adds the outputs, what is asked for and how the mesh is taken, without mesh and server. Parsing checks each option by
// itself, and pairs of options that exclude each other.
void AddRequestOptions(CommandParser& command, VoxelizeWords& words);

// "W" or "Wv"; nothing if it is neither.
std::optional<Band> ParseBand(absl::string_view text);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_REQUEST_ROWS_H_
