// `latvox compare`.
#ifndef LATVOX_CLIENT_TOOL_CLI_COMPARE_COMMAND_H_
#define LATVOX_CLIENT_TOOL_CLI_COMPARE_COMMAND_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "deploy/manual/command_parser.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// The words as given. Parsing writes into them.
struct CompareWords {
  std::string a, b;
  bool voxels_only = false, json = false;
  std::vector<std::string> outputs;
};

void AddCompareOptions(CommandParser& command, CompareWords& words);

// Throws UsageError: an output is given twice, or is one of the compared files.
void Check(const CompareWords& words);

struct Comparison {
  bool equal = false;
  std::string text;  // for standard output
};

// Compares two .vdb files: voxels, metadata, and the distances or attributes of the voxels that both have. With
// --voxels compares only the voxels. Both files are in memory: see ReadInputContent.
// Writes the outputs, which appear only if everything succeeded.
// Errors: as ReadInputContent; INVALID_ARGUMENT: a band, and voxels without distances, unless --voxels; outputs, but
// other positions; as WriteDifferences; CANCELLED.
absl::StatusOr<Comparison> RunCompare(const CompareWords& words, const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_COMPARE_COMMAND_H_
