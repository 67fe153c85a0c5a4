// `latvox view`.
#ifndef LATVOX_CLIENT_TOOL_CLI_VIEW_COMMAND_H_
#define LATVOX_CLIENT_TOOL_CLI_VIEW_COMMAND_H_

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// The words as they are given; CLI11 writes into them, so that they must outlive its parsing.
struct ViewWords {
  std::string input, view_up;
  std::vector<std::string> outputs;
};

void AddViewOptions(CLI::App& command, ViewWords& words);

// Throws CLI::ValidationError if the words do not go together.
void Check(const ViewWords& words);

// Writes the page; returns what belongs on standard output. The output appears only if everything succeeded.
absl::StatusOr<std::string> RunView(const ViewWords& words, const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_VIEW_COMMAND_H_
