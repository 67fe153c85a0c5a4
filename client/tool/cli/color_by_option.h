// --color-by and --label of commands that draw files.
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

// The words as given.
struct ColorByWords {
  std::string source, label;

  bool empty() const { return source.empty() && label.empty(); }
};

// Returns the rows of both. The label is no part of the word of --color-by: label_fractions:4 of --fields means 4^3
// points, not label 4.
std::vector<OptionRow> ColorByRows(ColorByWords& words);

// Throws UsageError if the words do not go together.
void Check(const ColorByWords& words);

// If --label is given, puts its fractions in the place of Field::kFraction. Errors: INVALID_ARGUMENT, with the path:
// the voxels do not carry them.
absl::Status SelectLabel(const ColorByWords& words, const std::string& path, GridContent& content);

// Returns the choice that the words name. If they are empty, returns the first that the file has, in the order of
// DefaultColorBy.
//   distances   whether the default may be distances
ColorBy ColorByOf(const ColorByWords& words, bool distances, const GridContent& content);

// Returns the colors of all voxels. Errors: INVALID_ARGUMENT, with the path: the file has no values of that name.
absl::StatusOr<std::vector<uint32_t>> FileColors(const std::string& path, const GridContent& content, ColorBy by);

// Returns ", colored by part" or ", colored by the fraction of heart", or "" for kNone.
std::string ColoredText(const ColorByWords& words, ColorBy by);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_COLOR_BY_OPTION_H_
