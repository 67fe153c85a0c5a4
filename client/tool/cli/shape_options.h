// The options of dense arrays: --npy, --array, --dims and --pad.
#ifndef LATVOX_CLIENT_TOOL_CLI_SHAPE_OPTIONS_H_
#define LATVOX_CLIENT_TOOL_CLI_SHAPE_OPTIONS_H_

#include <optional>
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

// Writes the options of arrays to `options`. Throws UsageError if --npy is about no output.
void InterpretShape(const ShapeWords& words, const std::vector<std::string>& outputs, OutputOptions& options);

// These two name the formats that can hold the voxels; all, if these are unknown.
// Throws UsageError if --array, --dims or --pad is about no output.
void CheckShape(const ShapeWords& words, const std::vector<std::string>& outputs, const OutputOptions& options,
                const std::optional<ToHold>& voxels);
// Throws UsageError if each output can hold all fields.
void CheckArrayOutput(const std::vector<std::string>& outputs, const OutputOptions& options,
                      const std::optional<ToHold>& voxels);

// Throws UsageError if --array has a field that voxels with these fields lack.
void CheckArray(const std::vector<Field>& fields, const OutputOptions& options);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_SHAPE_OPTIONS_H_
