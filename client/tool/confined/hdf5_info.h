// The facts of a .h5 file of latvox.
#ifndef LATVOX_CLIENT_TOOL_CONFINED_HDF5_INFO_H_
#define LATVOX_CLIENT_TOOL_CONFINED_HDF5_INFO_H_

#include <string>

#include "absl/status/statusor.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {

// Returns the facts as those of a grid: `name` is the set's group, `value_type` lists fields and links, and metadata
// are the attributes latvox_... Counts the voxels of all bricks. HDF5 trusts what it reads, so a foreign file needs a
// process without rights. Memory: some megabytes. Errors, with the path: INVALID_ARGUMENT: not a readable file of
// latvox; those of Hdf5::Load.
//   fd     of the file, stays open
//   path   for messages
absl::StatusOr<GridFileInfo> ReadHdf5Info(int fd, const std::string& path);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CONFINED_HDF5_INFO_H_
