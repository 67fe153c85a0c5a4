// Options of commands that draw: --background, --legend, --crop.
#ifndef LATVOX_CLIENT_TOOL_CLI_PICTURE_STYLE_OPTION_H_
#define LATVOX_CLIENT_TOOL_CLI_PICTURE_STYLE_OPTION_H_

#include <string>

#include "client/tool/output/picture_style.h"
#include "deploy/manual/command_parser.h"
#include "latvox/grid/grid_content.h"

namespace latvox::client {

// The words as given. Parsing writes into them.
struct PictureStyleWords {
  std::string background;
  bool legend = false, crop = false;
};

// Adds the options. `crop` is the help of --crop.
void AddPictureStyleOptions(CommandParser& command, const std::string& crop, PictureStyleWords& words);

// Returns the check of a color, six hexadecimal digits, and the color of such a word.
std::string CheckColor(const std::string& text);
Rgb8 ParseColor(const std::string& text);

// Returns the style, with the legend of these colors if the words ask for one.
PictureStyle StyleOf(const PictureStyleWords& words, const GridContent& content, ColorBy by);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_PICTURE_STYLE_OPTION_H_
