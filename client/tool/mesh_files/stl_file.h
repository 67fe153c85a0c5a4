// STL.
#ifndef LATVOX_CLIENT_TOOL_MESH_FILES_STL_FILE_H_
#define LATVOX_CLIENT_TOOL_MESH_FILES_STL_FILE_H_

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

// Whether the bytes are as many as those of a binary file with the number of triangles that they declare.
bool IsBinaryStl(absl::string_view bytes);

// Reads an STL file's bytes, binary or text, of one solid or several. Binary is what has that length, a zero byte, or
// no word of facets; bytes after its last triangle are ignored. Each solid is a part. Each triangle has vertices of its
// own; positions are the float32 of the file, or the nearest to its decimal text; normals are ignored. Errors:
// INVALID_ARGUMENT naming the line, or the triangle, from 0, and what is wrong: too few bytes for the count declared, a
// word that does not belong there, a coordinate that is not a finite number, a facet of other than three vertices.
absl::StatusOr<Mesh> ParseStl(absl::string_view bytes);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_MESH_FILES_STL_FILE_H_
