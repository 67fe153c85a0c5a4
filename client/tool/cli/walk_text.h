// The lines of a summary about enclosed parts and leaks.
#ifndef LATVOX_CLIENT_TOOL_CLI_WALK_TEXT_H_
#define LATVOX_CLIENT_TOOL_CLI_WALK_TEXT_H_

#include <string>

#include "client/tool/cli/report.h"

namespace latvox::client {

// Returns lines with their ends, or "" for a set that no walk made.
std::string WalkText(const VoxelizeReport& report);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_WALK_TEXT_H_
