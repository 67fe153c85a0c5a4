// `latvox encode`.
#ifndef LATVOX_CLIENT_TOOL_CLI_ENCODE_COMMAND_H_
#define LATVOX_CLIENT_TOOL_CLI_ENCODE_COMMAND_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/tool/cli/mesh_options.h"
#include "deploy/manual/command_parser.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// The words as given. Parsing writes into them.
struct EncodeWords : MeshWords {
  MeshSource mesh;  // with its paths
  std::vector<std::string> outputs;
  int quantization = 0;
};

void AddEncodeOptions(CommandParser& command, EncodeWords& words);

// Throws UsageError if the words do not go together.
MeshSource Interpret(const EncodeWords& words);

// Writes the positions and triangles of the mesh as a Draco stream. Returns the text for standard output. The output
// file appears only if everything succeeded.
absl::StatusOr<std::string> RunEncode(const EncodeWords& words, const MeshSource& source,
                                      const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_ENCODE_COMMAND_H_
