// `latvox convert`.
#ifndef LATVOX_CLIENT_TOOL_CLI_CONVERT_COMMAND_H_
#define LATVOX_CLIENT_TOOL_CLI_CONVERT_COMMAND_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/tool/cli/shape_options.h"
#include "client/tool/output/output.h"
#include "deploy/manual/command_parser.h"
#include "latvox/cancellation.h"
#include "latvox/fields.h"
#include "latvox/grid/grid_content.h"
#include "latvox/types.h"
#include "latvox/warning.h"

namespace latvox::client {

// The words as given. Parsing writes into them.
struct ConvertWords {
  std::string input, fields;
  std::vector<std::string> outputs;
  ShapeWords shape;
};

struct ConvertOptions {
  std::string input;
  std::vector<std::string> outputs;
  std::optional<std::vector<Field>> fields;  // absent: all of the file
  OutputOptions output_options;
};

void AddConvertOptions(CommandParser& command, ConvertWords& words);

// Returns the options that the words mean together. Throws UsageError if they do not go together.
ConvertOptions Interpret(const ConvertWords& words);

// The voxels of a file, with what outputs are told about them.
struct VoxelFile {
  GridContent content;
  VoxelizeRequest request;       // as far as outputs ask for it
  Accepted accepted;             // likewise
  Summary summary;               // likewise
  OutputOptions output_options;  // metadata, page and picture
};

// Reads a .vdb or .nvdb file. `fields`: those to keep; absent: all. Errors: those of ReadInputContent;
// INVALID_ARGUMENT: the file lacks a field.
absl::StatusOr<VoxelFile> ReadVoxelFile(const std::string& path, const std::optional<std::vector<Field>>& fields,
                                        const Cancellation& cancellation);

// Writes all voxels of the file with their fields. Dense arrays cover the box of the file's voxels. Returns the text
// for standard output. The outputs appear only if everything succeeded.
//   warnings   receives those of the outputs
// Errors, before a file is written:
// INVALID_ARGUMENT: the file lacks a field; an output cannot hold the fields or the lattice, naming those that can.
absl::StatusOr<std::string> RunConvert(const ConvertOptions& options, const Cancellation& cancellation,
                                       std::vector<Warning>& warnings);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_CONVERT_COMMAND_H_
