// `latvox compare`.
#ifndef LATVOX_CLIENT_TOOL_CLI_COMPARE_COMMAND_H_
#define LATVOX_CLIENT_TOOL_CLI_COMPARE_COMMAND_H_

#include <string>

#include "absl/status/statusor.h"
#include "deploy/manual/command_parser.h"

namespace latvox::client {

// The words as they are given; parsing writes into them.
struct CompareWords {
  std::string a, b;
  bool voxels_only = false, json = false;
};

void AddCompareOptions(CommandParser& command, CompareWords& words);

struct Comparison {
  bool equal = false;
  std::string text;  // what belongs on standard output
};

// Of two .vdb files: their voxels, and unless these alone are asked for, their metadata and the distances or attributes
// of the voxels that both have. Both are in memory: see ReadGridContent. Errors: as there; INVALID_ARGUMENT: a band and
// a set of voxels, unless voxels alone are asked for.
absl::StatusOr<Comparison> RunCompare(const CompareWords& words);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_COMPARE_COMMAND_H_
