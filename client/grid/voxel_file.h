// Writes a .vdb file with a set of voxels, without OpenVDB. Internal to latvox::grid and the tool.
#ifndef LATVOX_CLIENT_GRID_VOXEL_FILE_H_
#define LATVOX_CLIENT_GRID_VOXEL_FILE_H_

#include <functional>
#include <string>

#include "absl/status/status.h"
#include "client/grid/brick_tree.h"
#include "client/grid/metadata.h"
#include "client/grid/tree_survey.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// Returns the metadata, with the grid's name. OpenVDB's statistics, file_..., replace those that are there. An
// exception ends the writing.
using DescribeVoxels = std::function<Metadata(const VoxelCounts&)>;

// Writes a BoolGrid to `path`, replacing an existing file; not atomic. The file equals, byte for byte, the one that
// WriteGridFile writes of the same grid, pruned: full bricks are tiles of lower nodes, full lower nodes tiles of upper
// nodes, and full upper nodes tiles of the root. The file has the topology of all nodes first, and then the values of
// all leaves, so it goes through the nodes three times.
//
// grid_frame.h tells the layout around the tree. The tree, where each mask has the bytes of NodeMask:
//
//   root    number of buffers, 1; background, a byte; numbers of tiles and of children; tiles: i, j, k of the low
//           corner, a byte for the value and one for "active"; children: i, j, k, and an upper node
//   node    masks of children and of active tiles; a byte 0: all others are background; size of the compressed values
//           of the tiles, 64 bits, and these; the children
//   leaf    mask of its voxels
//
// Behind it come the leaves again, 140 bytes each: the mask, i, j and k of the low corner, and the mask as values.
//
// `transform` is as a file has it: see TransformBytes. Memory: that of TreeSurvey, and a few megabytes. Errors: those
// of WriteNewFile.
absl::Status WriteVoxelFile(LowerNodes& nodes, const std::string& transform, const DescribeVoxels& describe,
                            const std::string& path, const Cancellation& cancellation = {});

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_VOXEL_FILE_H_
