// `latvox compare`.
#ifndef LATVOX_CLIENT_TOOL_CLI_COMPARE_COMMAND_H_
#define LATVOX_CLIENT_TOOL_CLI_COMPARE_COMMAND_H_

#include <string>

#include "absl/status/statusor.h"
#include "deploy/manual/command_parser.h"

namespace latvox::client {

// The words as given. Parsing writes into them.
struct CompareWords {
  std::string a, b;
  bool voxels_only = false, json = false;
};

void AddCompareOptions(CommandParser& command, CompareWords& words);

struct Comparison {
  bool equal = false;
  std::string text;  // for standard output
};

// Compares two .vdb files: voxels, metadata, and the distances or attributes of the voxels that both have. With
// --voxels compares only the voxels. Both files are in memory: see ReadGridContent.
// Errors: as ReadGridContent; INVALID_ARGUMENT: a band and a set of voxels without --voxels.
absl::StatusOr<Comparison> RunCompare(const CompareWords& words);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_COMPARE_COMMAND_H_
