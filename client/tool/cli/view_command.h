// `latvox view`.
#ifndef LATVOX_CLIENT_TOOL_CLI_VIEW_COMMAND_H_
#define LATVOX_CLIENT_TOOL_CLI_VIEW_COMMAND_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "deploy/manual/command_parser.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// The words as given. Parsing writes into them.
struct ViewWords {
  std::string input, view_up;
  std::vector<std::string> outputs;
};

void AddViewOptions(CommandParser& command, ViewWords& words);

// Throws UsageError if the words do not go together.
void Check(const ViewWords& words);

// Writes the page. Returns the text for standard output. The output file appears only if everything succeeded.
absl::StatusOr<std::string> RunView(const ViewWords& words, const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_VIEW_COMMAND_H_
