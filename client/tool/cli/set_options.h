// The options of the set and of the fields: --set, --rule, --force-open, --seed, --close, --leak-from, --allow-outside,
// --band, --side, --fields, --labels, --priority, --fraction-labels and --signed.
#ifndef LATVOX_CLIENT_TOOL_CLI_SET_OPTIONS_H_
#define LATVOX_CLIENT_TOOL_CLI_SET_OPTIONS_H_

#include <vector>

#include "client/tool/cli/voxelize_options.h"
#include "deploy/manual/option_row.h"

namespace latvox::client {

std::vector<OptionRow> SetRows(VoxelizeWords& words);

// Returns the set that the words mean. Throws UsageError, as InterpretRequest.
VoxelSet InterpretSet(const VoxelizeWords& words);

// Writes the fields to `options`, and what they need. Throws UsageError, as InterpretRequest.
void InterpretFields(const VoxelizeWords& words, VoxelizeOptions& options);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_SET_OPTIONS_H_
