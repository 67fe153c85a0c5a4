// Stanford PLY.
#ifndef LATVOX_CLIENT_MESH_FILES_PLY_FILE_H_
#define LATVOX_CLIENT_MESH_FILES_PLY_FILE_H_

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/parse_options.h"

namespace latvox::client {

// Reads a PLY file's bytes: ascii, or binary of either byte order. Reads these properties; other elements and
// properties are ignored:
//   vertex      x, y, z in any scalar type, text as the nearest double; colors (ply_color.h)
//   face        vertex_indices (or vertex_index); polygons are triangulated; faces of fewer than three corners are
//               counted as skipped; colors, unless vertices have some, which gives IGNORED_COLOR
//   tristrips   vertex_indices (or vertex_index); -1 ends a strip
// In text, each element is a line: more values than the header tells give the warning EXTRA_VALUES, fewer are an error.
// Bytes after the last element give TRAILING_DATA, unmarked comments in the header UNKNOWN_HEADER.
// Errors: INVALID_ARGUMENT naming the fault: the header, a missing element or property, too few bytes for the declared
// counts, a face whose vertex is not finite, a vertex index out of range. Vertices and faces are counted from 0, as in
// the format.
absl::StatusOr<Mesh> ParsePly(absl::string_view bytes, const ParseOptions& options = {});

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_PLY_FILE_H_
