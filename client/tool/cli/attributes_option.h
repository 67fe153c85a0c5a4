// --attributes, and which outputs hold what is asked for.
#ifndef LATVOX_CLIENT_TOOL_CLI_ATTRIBUTES_OPTION_H_
#define LATVOX_CLIENT_TOOL_CLI_ATTRIBUTES_OPTION_H_

#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "client/tool/cli/voxelize_options.h"
#include "deploy/manual/option_row.h"

namespace latvox::client {

OptionRow AttributesRow(VoxelizeWords& words);

// What the option asks for, if it is given. Throws UsageError, as InterpretRequest.
//   options   all else is interpreted
void InterpretAttributes(const VoxelizeWords& words, VoxelizeOptions& options);

// Refuses outputs whose extension is none of these: they cannot hold what the option asks for.
void CheckCarry(const char* option, absl::string_view what, const std::vector<std::string>& extensions,
                const std::vector<std::string>& outputs);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_ATTRIBUTES_OPTION_H_
