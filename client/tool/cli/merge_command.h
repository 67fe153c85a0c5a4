// `latvox merge`.
#ifndef LATVOX_CLIENT_TOOL_CLI_MERGE_COMMAND_H_
#define LATVOX_CLIENT_TOOL_CLI_MERGE_COMMAND_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "deploy/manual/command_parser.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// The words as given. Parsing writes into them.
struct MergeWords {
  std::vector<std::string> parts, outputs;
  bool json = false;
};

void AddMergeOptions(CommandParser& command, MergeWords& words);

// Throws UsageError if the words do not go together.
void Check(const MergeWords& words);

// Joins the parts. Returns the text for standard output. The output file appears only if everything succeeded. Raises
// the limit of open files as far as the process may, because every part stays open.
absl::StatusOr<std::string> RunMerge(const MergeWords& words, const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_MERGE_COMMAND_H_
