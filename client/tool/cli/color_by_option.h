// --color-by, of commands that draw files.
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

//   distances   a band may be colored by them, and is unless somebody says otherwise
OptionRow ColorByRow(bool distances, std::string& word);

// What the word names; empty: what the file has, in the order of DefaultColorBy.
ColorBy ColorByOf(const std::string& word, bool distances, const GridContent& content);

// Of all voxels. Errors: INVALID_ARGUMENT, with the path: the file has nothing of that name.
absl::StatusOr<std::vector<uint32_t>> FileColors(const std::string& path, const GridContent& content, ColorBy by);

// ", colored by part", if they are.
std::string ColoredText(ColorBy by);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_COLOR_BY_OPTION_H_
