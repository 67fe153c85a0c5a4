// The vertices of a Wavefront OBJ file.
#ifndef LATVOX_CLIENT_MESH_FILES_OBJ_VERTICES_H_
#define LATVOX_CLIENT_MESH_FILES_OBJ_VERTICES_H_

#include "absl/status/status.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/bad_elements.h"

namespace latvox::client {

// Reads the `v` statements of the text into mesh.positions, with one color for each in mesh.colors, if there are any:
//   v x y z          v x y z r g b
//   v x y z w        v x y z w r g b, with w = 1 everywhere; otherwise, v x y z r g b a
// A weight w is not applied; others than 1 give the warning IGNORED_WEIGHTS. Positions may be infinite or NaN.
// A vertex without a color, where others have one, is white; the warning is PARTIAL_COLORS. mesh.no_color tells why
// numbers are no colors. Errors, through `bad`: INVALID_ARGUMENT naming the line, if a coordinate is not a number.
absl::Status ReadObjVertices(absl::string_view text, BadElements& bad, Mesh& mesh);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_OBJ_VERTICES_H_
