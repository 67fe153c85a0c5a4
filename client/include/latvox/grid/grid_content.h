// All that a .vdb file of latvox holds: voxels, and what they have besides their places. No OpenVDB header is needed to
// use this.
#ifndef LATVOX_LATVOX_GRID_GRID_CONTENT_H_
#define LATVOX_LATVOX_GRID_GRID_CONTENT_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "latvox/export.h"
#include "latvox/grid/voxel_grid.h"
#include "latvox/types.h"

namespace latvox::client {

// Numbers are in the order of BrickBatch: brick after brick, of a brick in lexicographic order of ijk.
struct GridContent {
  GridFile file;                            // of a band, the voxels within it
  std::optional<Band> band = std::nullopt;  // of a grid "distance": its width in world units; absent of any other
  std::vector<float> distances = {};        // of a band: one for each voxel, world units
  std::vector<Attribute> attributes = {};   // what voxels carry: part, material, color, in this order
  std::vector<uint32_t> numbers = {};       // as many for each voxel

  // All bricks, and what is theirs.
  BrickBatch Batch() const { return {file.bricks, 1, distances, numbers}; }
};

// Reads voxels as ReadGridFile does, with the grids "part", "material" and "color" beside them (see
// latvox/grid/attribute_grids.h); or, where the file's first grid is one of floats named "distance", a
// band (see latvox/grid/distance_grid.h). What the metadata do not say of a band is found in its
// distances. Memory: that of ReadGridFile, 4 bytes for each number, and a grid at a time while it reads: see
// DistanceGrid, AttributeGrids. Errors: as ReadGridFile; INVALID_ARGUMENT: a grid that has other voxels than the set;
// values that latvox does not write.
//   values   false: distances and attributes are left out
LATVOX_EXPORT absl::StatusOr<GridContent> ReadGridContent(const std::string& path, bool values = true);

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_GRID_GRID_CONTENT_H_
