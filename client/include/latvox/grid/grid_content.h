// The content of a .vdb file of latvox: voxels with their fields. Programs need no OpenVDB header for this.
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

// The range of distances.
struct DistanceRange {
  double most = 0;         // their greatest size; of a band, its width; world units
  bool is_signed = false;  // they are negative inside
  bool operator==(const DistanceRange&) const = default;
};

// The voxels of a file.
struct GridContent {
  GridFile file;                                          // with the set
  bool is_band = false;                                   // the file has no set except the grid "distance"
  std::vector<FieldValues> fields = {};                   // of the voxels, in the order of kFields
  std::optional<DistanceRange> distances = std::nullopt;  // if Field::kDistance is among them
  std::vector<Vec3i> neighbors = {};                      // as in Accepted, if a field of links is among them

  // Returns all bricks with their fields.
  BrickBatch Batch() const { return {file.bricks, 1, fields}; }
};

// Reads voxels like ReadGridFile, with the grids of fields (see latvox/grid/field_grids.h). If the file has no grid
// "voxels", but one of floats with the name "distance", reads a band (see latvox/grid/distance_grid.h). Facts that the
// metadata lack come from the distances. Memory: that of ReadGridFile, the fields, and one grid at a time while it
// reads: see DistanceGrid, FieldGrids. Errors: as ReadGridFile; INVALID_ARGUMENT if a grid has other voxels than the
// set, or values that latvox does not write.
//   values   false: leaves out the fields
LATVOX_EXPORT absl::StatusOr<GridContent> ReadGridContent(const std::string& path, bool values = true);

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_GRID_GRID_CONTENT_H_
