// Text in pictures. The letters are our own lines, because pictures must be the same on every machine, and a font would
// be one more file for containers and packages.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_LETTERING_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_LETTERING_H_

#include "absl/strings/string_view.h"
#include "client/tool/output/image.h"

namespace latvox::client {

// Returns the width of a text whose digits are `height` pixels high.
double LetteringWidth(absl::string_view text, double height);

// Draws a text in UTF-8 over the picture, as far as it lies within: letters from A to Z, digits, and marks of numbers
// and names. A box stands for any other character. (x, y) is the left end of the base line.
void Letter(absl::string_view text, double x, double y, double height, const Rgb8& color, Image& image);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_LETTERING_H_
