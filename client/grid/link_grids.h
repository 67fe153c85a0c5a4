// The grids of links: a grid for each field and neighbor. Includes OpenVDB's headers. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_LINK_GRIDS_H_
#define LATVOX_CLIENT_GRID_LINK_GRIDS_H_

#include <span>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/grid/grid_archive.h"
#include "client/grid/late_grids.h"
#include "latvox/grid/grid_content.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns the grids of those fields that are of links, with the names, types and active voxels that
// latvox/grid/field_grids.h states. All arguments must outlive the result.
//   like   the grid of the set: all grids get its transform, and its metadata except name and class
LateGrids LinkGrids(std::span<const Brick> bricks, std::span<const FieldValues> fields,
                    std::span<const Vec3i> neighbors, const openvdb::GridBase& like);

// Returns the neighbors that the names of grids tell, in the order of Accepted::neighbors; none without fields of
// links. Errors: INVALID_ARGUMENT, with the path: a field lacks the grid of a neighbor, or of its opposite; the zero
// vector is one; more than kMostNeighbors.
absl::StatusOr<std::vector<Vec3i>> ReadNeighbors(const GridArchive& archive, const std::string& path);

// Appends the fields of links to content.fields. Precondition: the content has its bricks, and the result of
// ReadNeighbors as neighbors. Errors: INVALID_ARGUMENT, with the path and the grid: it has another type, a voxel that
// is not in the set, or a value that latvox does not write; a link is crossed in one field, and in another it is not.
absl::Status ReadLinks(GridArchive& archive, const std::string& path, GridContent& content);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_LINK_GRIDS_H_
