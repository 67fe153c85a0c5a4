// `latvox render`.
#ifndef LATVOX_CLIENT_TOOL_CLI_RENDER_COMMAND_H_
#define LATVOX_CLIENT_TOOL_CLI_RENDER_COMMAND_H_

#include <CLI/App.hpp>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/tool/output/picture.h"

namespace latvox::client {

// The words as they are given; CLI11 writes into them, so that they must outlive its parsing.
struct RenderWords {
  std::string input, view_up, view, color, color_by;
  std::vector<std::string> outputs;
  PictureOptions picture;
};

void AddRenderOptions(CLI::App& command, RenderWords& words);

// Throws CLI::ValidationError if the words do not go together.
PictureOptions Interpret(const RenderWords& words);

// Draws the file; returns what belongs on standard output. The output appears only if everything succeeded.
absl::StatusOr<std::string> RunRender(const RenderWords& words, const PictureOptions& options);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_RENDER_COMMAND_H_
