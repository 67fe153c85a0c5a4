// The options of a request: rows of the table that `latvox voxelize` and a line of `latvox batch` share.
#ifndef LATVOX_CLIENT_TOOL_CLI_REQUEST_ROWS_H_
#define LATVOX_CLIENT_TOOL_CLI_REQUEST_ROWS_H_

#include <optional>

#include "absl/strings/string_view.h"
#include "client/tool/cli/voxelize_options.h"
#include "deploy/manual/command_parser.h"
#include "latvox/types.h"

namespace latvox::client {

// Adds the options of outputs, request and mesh, except mesh paths and server. Parsing checks each option alone, and
// pairs of options that exclude each other.
void AddRequestOptions(CommandParser& command, VoxelizeWords& words);

// Parses "W" or "Wv". Returns nothing if the text is neither.
std::optional<Band> ParseBand(absl::string_view text);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_REQUEST_ROWS_H_
