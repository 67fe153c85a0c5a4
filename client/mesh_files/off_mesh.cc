#include "client/mesh_files/off_mesh.h"

#include <utility>

#include "client/mesh_files/indexed_faces.h"
#include "client/mesh_files/triangle_colors.h"

namespace latvox::client {

void OffColors::Add(const std::optional<OffColor>& color) {
  for (const bool integers : {false, true}) {
    if (color && color->is_integers == integers) {
      numbers_[integers].Add(color->rgb);
    } else {
      numbers_[integers].AddMissing();
    }
  }
  kinds_.push_back(color ? std::optional(color->is_integers) : std::nullopt);
}

absl::StatusOr<std::vector<std::optional<Color>>> OffColors::ToBytes(const std::string& element) const {
  std::vector<std::optional<Color>> colors(size());
  for (const bool integers : {false, true}) {
    const auto bytes = numbers_[integers].ToBytes(element, 0);
    if (!bytes.ok()) return bytes.status();
    for (size_t n = 0; n < size(); ++n) {
      if (kinds_[n] == integers) colors[n] = (*bytes)[n];
    }
  }
  return colors;
}

void OffMesh::AddVertex(const Vec3d& position, const std::optional<OffColor>& color) {
  mesh_.positions.push_back(position);
  if (color || !vertex_colors_.empty()) {
    while (vertex_colors_.size() + 1 < mesh_.positions.size()) vertex_colors_.Add(std::nullopt);
    vertex_colors_.Add(color);
  }
}

absl::Status OffMesh::AddFace(const std::vector<double>& indices, const std::optional<OffColor>& color, uint64_t n) {
  const size_t before = mesh_.triangles.size();
  if (auto status = AppendFace(indices, n, mesh_); !status.ok()) return status;
  if (!color && triangle_colors_.empty()) return absl::OkStatus();
  while (triangle_colors_.size() < before) triangle_colors_.Add(std::nullopt);
  while (triangle_colors_.size() < mesh_.triangles.size()) triangle_colors_.Add(color);
  return absl::OkStatus();
}

// A vertex without a color is a broken one, which no face uses.
void OffMesh::TakeVertexColors() {
  const auto colors = vertex_colors_.ToBytes("vertex");
  if (!colors.ok()) {
    mesh_.no_color = std::string(colors.status().message());
    return;
  }
  for (const auto& color : *colors) mesh_.colors.push_back(color.value_or(Color{255, 255, 255}));
}

void OffMesh::TakeFaceColors() {
  if (!vertex_colors_.empty()) return WarnOfFaceColors(mesh_);
  const auto colors = triangle_colors_.ToBytes("triangle");
  if (colors.ok()) {
    ColorTriangles(*colors, mesh_);
  } else {
    mesh_.no_color = std::string(colors.status().message());
  }
}

Mesh OffMesh::Finish() && {
  if (!vertex_colors_.empty()) TakeVertexColors();
  if (!triangle_colors_.empty()) TakeFaceColors();
  bad_.Report(mesh_);
  RemoveNotFinite(mesh_);
  return std::move(mesh_);
}

}  // namespace latvox::client
