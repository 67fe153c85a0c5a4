// The resolution that --dims asks for.
#ifndef LATVOX_CLIENT_TOOL_CLI_DIMS_RESOLUTION_H_
#define LATVOX_CLIENT_TOOL_CLI_DIMS_RESOLUTION_H_

#include <cstdint>
#include <optional>

#include "absl/functional/function_ref.h"
#include "absl/status/statusor.h"
#include "client/tool/output/box_shape.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns the box of the voxels at a resolution, or nothing without a voxel.
using MeasureBox = absl::FunctionRef<absl::StatusOr<std::optional<IndexBox>>(uint32_t resolution)>;

// Returns a resolution whose voxels, with their padding, fit into dims, although those of the next one do not, or it is
// the greatest. No formula tells: the box depends on set, lattice and mesh. So this measures some three to five
// resolutions. Errors: INVALID_ARGUMENT: the voxels of the least resolution do not fit; those of `measure`.
//   shape   with dims
absl::StatusOr<uint32_t> FindResolution(const BoxShape& shape, MeasureBox measure);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_DIMS_RESOLUTION_H_
