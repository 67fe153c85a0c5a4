// Reads .vdb, .nvdb and .h5 files that anybody may have written.
#ifndef LATVOX_CLIENT_TOOL_CONFINED_FOREIGN_GRID_H_
#define LATVOX_CLIENT_TOOL_CONFINED_FOREIGN_GRID_H_

#include <string>

#include "absl/status/statusor.h"
#include "latvox/cancellation.h"
#include "latvox/grid/grid_content.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {

// Like ReadGridFileInfo (of a .h5, ReadHdf5Info) and ReadGridContent, in a process without rights (see ReaderProcess).
// Errors as there, and: INVALID_ARGUMENT: the process crashed, or went beyond ReaderLimits; RESOURCE_EXHAUSTED: the
// system had no memory or no process for it; CANCELLED; those of Vdb::Load. Memory of the reading process: see
// ReadGridContent; of this one: that of the result. This process must be a program whose main() asks IsReader.
absl::StatusOr<GridFileInfo> ReadForeignInfo(const std::string& path, const Cancellation& cancellation = {});
absl::StatusOr<GridContent> ReadForeignContent(const std::string& path, bool values = true,
                                               const Cancellation& cancellation = {});

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CONFINED_FOREIGN_GRID_H_
