// `latvox render`.
#ifndef LATVOX_CLIENT_TOOL_CLI_RENDER_COMMAND_H_
#define LATVOX_CLIENT_TOOL_CLI_RENDER_COMMAND_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/tool/cli/color_by_option.h"
#include "client/tool/cli/picture_style_option.h"
#include "client/tool/output/picture.h"
#include "deploy/manual/command_parser.h"

namespace latvox::client {

// The words as given. Parsing writes into them.
struct RenderWords {
  std::string input, view_up, view, color;
  ColorByWords color_by;
  std::vector<std::string> outputs;
  PictureOptions picture;
  PictureStyleWords style;
};

void AddRenderOptions(CommandParser& command, RenderWords& words);

// Throws UsageError if the words do not go together.
PictureOptions Interpret(const RenderWords& words);

// Draws the file. Returns the text for standard output. The output file appears only if everything succeeded.
absl::StatusOr<std::string> RunRender(const RenderWords& words, const PictureOptions& given);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_RENDER_COMMAND_H_
