#include "client/mesh_files/mesh_join.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/mesh/mesh_attributes.h"

namespace latvox::client {

absl::Status Transform(const Affine& to_world, Mesh& mesh) {
  if (to_world == kIdentity) return absl::OkStatus();
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    Vec3d& position = mesh.positions[v];
    const Vec3d moved = Apply(to_world, position);
    for (const double coordinate : moved) {
      if (std::isfinite(coordinate)) continue;
      return absl::InvalidArgumentError(
          absl::StrCat("vertex ", v, " (", absl::StrJoin(position, " "), ") is not finite after its transform"));
    }
    position = moved;
  }
  if (Mirrors(to_world)) {
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
    for (auto& triangle : mesh.base_colors.triangles) std::swap(triangle.corners[1], triangle.corners[2]);
    for (auto& triangle : mesh.base_colors.vertices) std::swap(triangle[1], triangle[2]);
  }
  return absl::OkStatus();
}

namespace {

void AppendNames(const std::vector<std::string>& more, uint32_t first, std::vector<std::string>& names) {
  names.resize(std::min<size_t>(names.size(), first));
  for (uint32_t n = 0; n < more.size(); ++n) SetName(first + n, more[n], names);
}

// Continues the numbers of parts and materials. Call it before the triangles are appended.
void AppendStretches(const Mesh& part, Mesh& mesh) {
  if (part.triangles.empty()) return;
  const uint32_t parts = NextPart(mesh), materials = mesh.materials;
  const size_t triangles = mesh.triangles.size();
  AppendNames(part.part_names, parts, mesh.part_names);
  AppendNames(part.material_names, materials, mesh.material_names);
  if (mesh.stretches.empty() && triangles > 0) mesh.stretches.emplace_back();
  std::vector<Stretch> more = part.stretches;
  if (more.empty()) more.emplace_back();
  for (Stretch& stretch : more) {
    stretch.first += triangles;
    stretch.part += parts;
    if (stretch.material) *stretch.material += materials;
    mesh.stretches.push_back(stretch);
  }
  mesh.materials += part.materials;
}

// Continues the numbers of base colors. Call it before the triangles are appended.
void AppendBaseColors(const BaseColors& part, size_t triangles, BaseColors& colors) {
  if (part.triangles.empty()) return;
  const auto first = static_cast<uint32_t>(colors.all.size());
  colors.all.insert(colors.all.end(), part.all.begin(), part.all.end());
  colors.triangles.resize(triangles);
  for (TriangleBaseColor triangle : part.triangles) {
    if (triangle.number != TriangleBaseColor::kNone) triangle.number += first;
    colors.triangles.push_back(triangle);
  }
  if (part.vertices.empty()) return;
  constexpr LinearRgba kFull{1, 1, 1, 1};
  colors.vertices.resize(triangles, {kFull, kFull, kFull});
  colors.vertices.insert(colors.vertices.end(), part.vertices.begin(), part.vertices.end());
}

}  // namespace

absl::Status Append(Mesh part, const Affine& to_world, Mesh& mesh) {
  if (auto status = Transform(to_world, part); !status.ok()) return status;
  if (mesh.triangles.empty() && mesh.positions.empty()) {
    part.skipped += mesh.skipped;
    part.warnings.insert(part.warnings.begin(), mesh.warnings.begin(), mesh.warnings.end());
    mesh = std::move(part);
    return absl::OkStatus();
  }
  const size_t base = mesh.positions.size();
  if (base + part.positions.size() > UINT32_MAX) {
    return absl::InvalidArgumentError(absl::StrCat("more than ", UINT32_MAX, " vertices"));
  }
  if (mesh.colors.size() == base && part.colors.size() == part.positions.size()) {
    mesh.colors.insert(mesh.colors.end(), part.colors.begin(), part.colors.end());
  }
  if (mesh.no_color.empty()) mesh.no_color = part.no_color;
  AppendStretches(part, mesh);
  AppendBaseColors(part.base_colors, mesh.triangles.size(), mesh.base_colors);
  mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
  for (auto triangle : part.triangles) {
    for (uint32_t& vertex : triangle) vertex += static_cast<uint32_t>(base);
    mesh.triangles.push_back(triangle);
  }
  mesh.skipped += part.skipped;
  mesh.warnings.insert(mesh.warnings.end(), part.warnings.begin(), part.warnings.end());
  return absl::OkStatus();
}

}  // namespace latvox::client
