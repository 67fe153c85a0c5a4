// STL.
#ifndef LATVOX_CLIENT_MESH_FILES_STL_FILE_H_
#define LATVOX_CLIENT_MESH_FILES_STL_FILE_H_

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/parse_options.h"

namespace latvox::client {

// Returns whether the length is that of a binary file with the declared number of triangles.
bool IsBinaryStl(absl::string_view bytes);

// Reads an STL file's bytes, binary or text, with one or more solids. A file is text if it begins with "solid", and has
// words of facets before the first zero byte. Each solid is a part. Each triangle has its own vertices. Positions are
// the float32 of the file, or the doubles nearest to its decimal text. Normals are ignored, as are unknown words after
// "endloop" and "endfacet". Binary solids have colors if their headers contain "COLOR=" and four bytes. Warnings:
//   PARTIAL_COLORS    some binary solids have colors, and the others are white
//   NO_COUNT          binary, with a count of 0 or 2^32 - 1, which the length replaces
//   SEVERAL_SOLIDS    binary solids behind one another; all are read
//   NO_END            text without "endsolid"
//   TRAILING_DATA     other bytes or words after the last solid
// Errors: INVALID_ARGUMENT naming the line, or the triangle counted from 0, and the fault: too few bytes for the
// declared count, or an unexpected word. Errors, or broken elements: a coordinate that is not a finite number, a facet
// without exactly three vertices.
absl::StatusOr<Mesh> ParseStl(absl::string_view bytes, const ParseOptions& options = {});

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_STL_FILE_H_
