// Colors of triangles.
#ifndef LATVOX_CLIENT_MESH_FILES_TRIANGLE_COLORS_H_
#define LATVOX_CLIENT_MESH_FILES_TRIANGLE_COLORS_H_

#include <optional>
#include <vector>

#include "client/mesh/mesh.h"

namespace latvox::client {

// Gives the mesh the colors of its triangles, one for each. Triangles without a color, and those beyond the end of
// `colors`, are white, with the warning PARTIAL_COLORS.
void ColorTriangles(const std::vector<std::optional<Color>>& colors, Mesh& mesh);

// Warns that colors of faces have no effect, because vertices have colors, too: IGNORED_COLOR.
void WarnOfFaceColors(Mesh& mesh);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_TRIANGLE_COLORS_H_
