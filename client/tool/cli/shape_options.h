// The options of dense arrays: --npy, --dims and --pad.
#ifndef LATVOX_CLIENT_TOOL_CLI_SHAPE_OPTIONS_H_
#define LATVOX_CLIENT_TOOL_CLI_SHAPE_OPTIONS_H_

#include <string>
#include <vector>

#include "client/tool/output/output.h"
#include "deploy/manual/option_row.h"

namespace latvox::client {

// The words as given. Parsing writes into them.
struct ShapeWords {
  std::string npy, dims, pad;
  bool is_for_memory = false;  // the caller makes arrays of the voxels itself, so no output needs a shape
};

std::vector<OptionRow> ShapeRows(ShapeWords& words);

// Writes the shape to `options`. Throws UsageError if nothing has one.
void InterpretShape(const ShapeWords& words, const std::vector<std::string>& outputs, OutputOptions& options);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_SHAPE_OPTIONS_H_
