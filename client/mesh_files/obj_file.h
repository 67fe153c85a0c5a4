// Wavefront OBJ.
#ifndef LATVOX_CLIENT_MESH_FILES_OBJ_FILE_H_
#define LATVOX_CLIENT_MESH_FILES_OBJ_FILE_H_

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

// Reads the `v` and `f` statements of an OBJ file. Positions are the nearest doubles to the decimal text. Polygons are
// triangulated. `l` and `p` elements are counted as skipped.
// - Each `o` with faces is a part.
// - Materials are the names of `usemtl`, in order of first use.
// - Three numbers from 0 to 1 after each position are colors.
// Everything else is ignored. Errors: INVALID_ARGUMENT naming line, value and limit: an index out of range, a
// coordinate that is not a finite number, a face of fewer than three corners.
absl::StatusOr<Mesh> ParseObj(absl::string_view text);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_OBJ_FILE_H_
