// `latvox slice`.
#ifndef LATVOX_CLIENT_TOOL_CLI_SLICE_COMMAND_H_
#define LATVOX_CLIENT_TOOL_CLI_SLICE_COMMAND_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/tool/output/pixel_picture.h"
#include "deploy/manual/command_parser.h"
#include "latvox/cancellation.h"
#include "latvox/plane_types.h"
#include "latvox/types.h"

namespace latvox::client {

// The words as they are given; parsing writes into them.
struct SliceWords {
  std::string input, axis, color_by;
  int index = 0, size = kPixelPictureSide;
  std::vector<std::string> outputs;
};

void AddSliceOptions(CommandParser& command, SliceWords& words);

// Throws UsageError if the words do not go together.
void Check(const SliceWords& words);

// The lattice points of which coordinate `axis` is `index`, as a lattice of their plane. Its first basis vector points
// to the right; its coordinates are the other two of ijk, in their order.
struct Layer {
  PlaneTransform grid;
  Vec3d right, up;  // unit vectors of the plane's x and y, from the world's origin on
};
Layer LayerOf(const GridTransform& grid, size_t axis, int32_t index);

// Draws or lists the layer; returns what belongs on standard output. Of a band, lists have its distances, and pictures
// are colored by them, with a line where the sign changes; of attributes, lists have these, and pictures are colored by
// the one that --color-by names. All layers across one axis show the same part of the world. The outputs appear only if
// everything succeeded. Errors: INVALID_ARGUMENT: the index is outside the box of the file's voxels.
absl::StatusOr<std::string> RunSlice(const SliceWords& words, const Cancellation& cancellation);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_SLICE_COMMAND_H_
