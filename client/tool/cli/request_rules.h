// Which options of a request do not go together. The server judges a request, too; here the answer comes before a mesh
// is read, and names options.
#ifndef LATVOX_CLIENT_TOOL_CLI_REQUEST_RULES_H_
#define LATVOX_CLIENT_TOOL_CLI_REQUEST_RULES_H_

#include "client/tool/cli/voxelize_options.h"
#include "deploy/manual/option_row.h"
#include "latvox/types.h"

namespace latvox::client {

// Options that exclude each other whatever their values are.
const OptionPairs& RequestExclusions();

// Refuses values that exclude each other. Throws UsageError.
void CheckRequestRules(const VoxelizeWords& words, const VoxelizeRequest& request);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_REQUEST_RULES_H_
