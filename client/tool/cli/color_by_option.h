// --color-by of commands that draw files.
#ifndef LATVOX_CLIENT_TOOL_CLI_COLOR_BY_OPTION_H_
#define LATVOX_CLIENT_TOOL_CLI_COLOR_BY_OPTION_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/tool/output/voxel_colors.h"
#include "deploy/manual/option_row.h"
#include "latvox/grid/grid_content.h"

namespace latvox::client {

// Returns the row of --color-by.
OptionRow ColorByRow(std::string& word);

// Returns the choice that the word names. If it is empty, returns the first that the file has, in the order of
// DefaultColorBy.
//   distances   whether the default may be distances
ColorBy ColorByOf(const std::string& word, bool distances, const GridContent& content);

// Returns the colors of all voxels. Errors: INVALID_ARGUMENT, with the path: the file has no values of that name.
absl::StatusOr<std::vector<uint32_t>> FileColors(const std::string& path, const GridContent& content, ColorBy by);

// Returns ", colored by part", or "" for kNone.
std::string ColoredText(ColorBy by);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_COLOR_BY_OPTION_H_
