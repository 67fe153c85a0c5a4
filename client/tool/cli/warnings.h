// Warnings of commands, for people.
#ifndef LATVOX_CLIENT_TOOL_CLI_WARNINGS_H_
#define LATVOX_CLIENT_TOOL_CLI_WARNINGS_H_

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "latvox/types.h"
#include "latvox/warning.h"

namespace latvox::client {

// Says each warning in a line, and EMPTY_SHARD as a note. Errors: INVALID_ARGUMENT naming the codes, if `strict` and
// there are any, except notes.
absl::Status Warn(const std::vector<Warning>& warnings, bool strict,
                  const std::function<void(const std::string& line)>& say);

// Returns MANY_VOXELS if the whole of a mesh is so long, in voxels of a given size, that its unit is perhaps another
// one, and the result may fill memory and disk. A resolution says how long it is.
std::optional<Warning> WarningOfSize(const Accepted& accepted, const VoxelizeRequest& request);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_WARNINGS_H_
