// `latvox slice`.
#ifndef LATVOX_CLIENT_TOOL_CLI_SLICE_COMMAND_H_
#define LATVOX_CLIENT_TOOL_CLI_SLICE_COMMAND_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/tool/cli/color_by_option.h"
#include "client/tool/cli/picture_style_option.h"
#include "client/tool/output/pixel_picture.h"
#include "deploy/manual/command_parser.h"
#include "latvox/cancellation.h"
#include "latvox/plane_types.h"
#include "latvox/types.h"

namespace latvox::client {

// The words as given. Parsing writes into them.
struct SliceWords {
  std::string input, axis = "z";
  ColorByWords color_by;
  std::optional<int> index;  // absent: in the middle of the file's voxels
  int size = kPixelPictureSide;
  PictureStyleWords style;
  std::vector<std::string> outputs;
};

void AddSliceOptions(CommandParser& command, SliceWords& words);

// Throws UsageError if the words do not go together.
void Check(const SliceWords& words);

// The lattice points whose coordinate `axis` is `index`, as a lattice of their plane. Its first basis vector points to
// the right. Its coordinates are the other two of ijk, in order.
struct Layer {
  PlaneTransform grid;
  Vec3d right, up;  // unit vectors of the plane's x and y, from the world's origin on
};
Layer LayerOf(const GridTransform& grid, size_t axis, int32_t index);

// Draws or lists the layer. Returns the text for standard output. The outputs appear only if everything succeeded.
//   band         lists have a column of distances; pictures are colored by them, with a line where the sign changes
//   attributes   lists have their columns; pictures are colored by the attribute that --color-by names
// All layers across one axis show the same part of the world, except with --crop. Errors: INVALID_ARGUMENT: the index
// is outside the box of the file's voxels.
absl::StatusOr<std::string> RunSlice(const SliceWords& words, const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_SLICE_COMMAND_H_
