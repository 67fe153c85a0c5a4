// STL.
#ifndef LATVOX_CLIENT_MESH_FILES_STL_FILE_H_
#define LATVOX_CLIENT_MESH_FILES_STL_FILE_H_

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

// Returns whether the length is that of a binary file with the declared number of triangles.
bool IsBinaryStl(absl::string_view bytes);

// Reads an STL file's bytes, binary or text, with one or more solids. A file is binary if it has the binary length,
// contains a zero byte, or has no word of facets. Bytes after the last triangle are ignored.
// Each solid is a part. Each triangle has its own vertices. Positions are the float32 of the file, or the doubles
// nearest to its decimal text. Normals are ignored. Errors: INVALID_ARGUMENT naming the line, or the triangle counted
// from 0, and the fault:
//   too few bytes for the declared count, or an unexpected word
//   a coordinate that is not a finite number
//   a facet without exactly three vertices
absl::StatusOr<Mesh> ParseStl(absl::string_view bytes);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_STL_FILE_H_
