// The options of dense arrays: --npy, --array, --dims and --pad.
#ifndef LATVOX_CLIENT_TOOL_CLI_SHAPE_OPTIONS_H_
#define LATVOX_CLIENT_TOOL_CLI_SHAPE_OPTIONS_H_

#include <string>
#include <vector>

#include "client/tool/output/output.h"
#include "deploy/manual/option_row.h"

namespace latvox::client {

// The words as given. Parsing writes into them.
struct ShapeWords {
  std::string npy, array, dims, pad;
  bool is_for_memory = false;  // the caller makes arrays of the voxels itself, so no output needs a shape
};

std::vector<OptionRow> ShapeRows(ShapeWords& words);

// Writes the options of arrays to `options`. Throws UsageError if no output has what they are about.
void InterpretShape(const ShapeWords& words, const std::vector<std::string>& outputs, OutputOptions& options);

// Throws UsageError if each output can hold all fields.
void CheckArrayOutput(const std::vector<std::string>& outputs, const OutputOptions& options);

// Throws UsageError if --array has a field that voxels with these fields lack.
void CheckArray(const std::vector<Field>& fields, const OutputOptions& options);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_SHAPE_OPTIONS_H_
