// Facts about boxes of cubes.
#ifndef LATVOX_CLIENT_TOOL_INSPECT_BOX_FACTS_H_
#define LATVOX_CLIENT_TOOL_INSPECT_BOX_FACTS_H_

#include "absl/status/statusor.h"
#include "client/json/json.h"
#include "client/tool/inspect/byte_source.h"

namespace latvox::client {

// Returns `voxels` and `shape` of a .binvox; `voxel_size` and `low_corner` place it in the world. Reads the whole file.
// Errors: INVALID_ARGUMENT: another header, runs of another length than the box, cut short.
absl::StatusOr<Json> BinvoxFacts(FileSource& file);

// Returns `voxels` and `shape` of a .vox (MagicaVoxel); of several models their sum and number, and no shape. Errors:
// INVALID_ARGUMENT: no such file, cut short.
absl::StatusOr<Json> VoxFacts(FileSource& file);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_INSPECT_BOX_FACTS_H_
