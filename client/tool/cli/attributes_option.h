// --attributes, and the outputs that can hold attributes.
#ifndef LATVOX_CLIENT_TOOL_CLI_ATTRIBUTES_OPTION_H_
#define LATVOX_CLIENT_TOOL_CLI_ATTRIBUTES_OPTION_H_

#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "client/tool/cli/voxelize_options.h"
#include "deploy/manual/option_row.h"

namespace latvox::client {

OptionRow AttributesRow(VoxelizeWords& words);

// Writes the attributes of the option to `options`, if it is given. Throws UsageError, as InterpretRequest.
//   options   otherwise complete
void InterpretAttributes(const VoxelizeWords& words, VoxelizeOptions& options);

// Throws UsageError if an output has none of these extensions, because it cannot hold the values of the option.
void CheckCarry(const char* option, absl::string_view what, const std::vector<std::string>& extensions,
                const std::vector<std::string>& outputs);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_ATTRIBUTES_OPTION_H_
