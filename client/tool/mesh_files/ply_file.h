// Stanford PLY.
#ifndef LATVOX_CLIENT_TOOL_MESH_FILES_PLY_FILE_H_
#define LATVOX_CLIENT_TOOL_MESH_FILES_PLY_FILE_H_

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

// Reads a PLY file's bytes: ascii, or binary of either byte order; x, y, z of element vertex in any scalar type, as the
// nearest float32; vertex_indices (or vertex_index) of element face, polygons triangulated, and of
// element tristrips, where -1 ends a strip; red, green and blue of vertices, or else diffuse_red and so on, as uchar,
// ushort, or float or double from 0 to 1: as the nearest of 256 steps. Other elements and properties are ignored. Faces
// of fewer than three corners are counted as skipped. Errors: INVALID_ARGUMENT naming what is wrong: the header, a
// missing element or property, too few bytes for the counts declared, vertex 17 not finite, a vertex index out of
// range. Vertices and faces are counted from 0, as in the format.
absl::StatusOr<Mesh> ParsePly(absl::string_view bytes);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_MESH_FILES_PLY_FILE_H_
