#include "client/mesh_files/triangle_colors.h"

#include <array>

#include "absl/strings/str_cat.h"
#include "client/mesh/mesh_attributes.h"

namespace latvox::client {

void ColorTriangles(const std::vector<std::optional<Color>>& colors, Mesh& mesh) {
  constexpr Color kBlank{255, 255, 255};
  std::vector<std::array<Color, 3>> corners(mesh.triangles.size(), {kBlank, kBlank, kBlank});
  size_t white = corners.size();
  for (size_t t = 0; t < corners.size() && t < colors.size(); ++t) {
    if (!colors[t]) continue;
    corners[t].fill(*colors[t]);
    --white;
  }
  ColorCorners(corners, mesh);
  if (white == 0) return;
  mesh.warnings.push_back({"PARTIAL_COLORS", absl::StrCat(white, " of ", mesh.triangles.size(),
                                                          " triangles have no color, and are white")});
}

void WarnOfFaceColors(Mesh& mesh) {
  mesh.warnings.push_back(
      {"IGNORED_COLOR", "faces and vertices have colors; those of vertices count, and those of faces have no effect"});
}

}  // namespace latvox::client
