// The content of a .vdb file of latvox: voxels, with their distances or attributes. Programs need no OpenVDB header for
// this.
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

// Numbers are in the order of BrickBatch: brick after brick, and within a brick in lexicographic order of ijk.
struct GridContent {
  GridFile file;                            // for a band, the voxels within it
  std::optional<Band> band = std::nullopt;  // for a grid "distance": the band's width in world units; absent for others
  std::vector<float> distances = {};        // for a band: one for each voxel, world units
  std::vector<Attribute> attributes = {};   // of the voxels: part, material, color, in this order
  std::vector<uint32_t> numbers = {};       // one for each voxel and attribute

  // Returns all bricks, with their distances and attributes.
  BrickBatch Batch() const { return {file.bricks, 1, distances, numbers}; }
};

// Reads voxels like ReadGridFile, with the grids "part", "material" and "color" (see latvox/grid/attribute_grids.h). If
// the file's first grid has floats and is named "distance", reads a band (see latvox/grid/distance_grid.h). Facts that
// the metadata lack come from the distances. Memory: that of ReadGridFile, 4 bytes for each number, and one grid at a
// time while it reads: see DistanceGrid, AttributeGrids. Errors: as ReadGridFile; INVALID_ARGUMENT if a grid has other
// voxels than the set, or values that latvox does not write.
//   values   false: leaves out distances and attributes
LATVOX_EXPORT absl::StatusOr<GridContent> ReadGridContent(const std::string& path, bool values = true);

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_GRID_GRID_CONTENT_H_
