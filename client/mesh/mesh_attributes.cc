#include "client/mesh/mesh_attributes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "client/internal/printable.h"
#include "latvox/error.h"

namespace latvox::client {
namespace {

bool Has(const Mesh& mesh, Field attribute) {
  const auto has_material = [](const Stretch& stretch) { return stretch.material.has_value(); };
  switch (attribute) {
    case Field::kPart:
      return true;
    case Field::kMaterial:
      return !mesh.stretches.empty() && mesh.stretches[0].first == 0 &&
             std::all_of(mesh.stretches.begin(), mesh.stretches.end(), has_material);
    case Field::kColor:
      return mesh.colors.size() == mesh.positions.size();
    default:
      return false;
  }
}

}  // namespace

void BeginStretch(uint32_t part, std::optional<uint32_t> material, Mesh& mesh) {
  const Stretch stretch{mesh.triangles.size(), part, material};
  if (mesh.stretches.empty() && stretch.first > 0) mesh.stretches.emplace_back();
  if (!mesh.stretches.empty() && mesh.stretches.back().first == stretch.first) {
    mesh.stretches.back() = stretch;
  } else {
    mesh.stretches.push_back(stretch);
  }
}

uint32_t NextPart(const Mesh& mesh) {
  if (mesh.triangles.empty()) return 0;
  if (mesh.stretches.empty()) return 1;
  const Stretch& last = mesh.stretches.back();
  return last.first < mesh.triangles.size() ? last.part + 1 : last.part;
}

void SetName(uint32_t number, absl::string_view name, std::vector<std::string>& names) {
  if (names.size() <= number && name.empty()) return;
  if (names.size() <= number) names.resize(size_t{number} + 1);
  names[number] = ValidUtf8(name);
}

Color ToColor(const float* rgb) {
  Color color;
  for (size_t n = 0; n < color.size(); ++n) {
    color[n] = static_cast<uint8_t>(std::nearbyint(double{std::min(std::max(0.0F, rgb[n]), 1.0F)} * 255));
  }
  return color;
}

void ColorCorners(const std::vector<std::array<Color, 3>>& colors, Mesh& mesh) {
  std::vector<std::optional<Color>> first(mesh.positions.size());  // of each vertex, the color seen first
  absl::flat_hash_map<std::pair<uint32_t, Color>, uint32_t> others;
  mesh.colors.assign(mesh.positions.size(), Color{});
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (size_t n = 0; n < 3; ++n) {
      uint32_t& vertex = mesh.triangles[t][n];
      const Color& color = colors[t][n];
      if (!first[vertex]) mesh.colors[vertex] = first[vertex].emplace(color);
      if (first[vertex] == color) continue;
      const auto next = static_cast<uint32_t>(mesh.positions.size());
      const auto [found, is_new] = others.try_emplace(std::pair(vertex, color), next);
      if (is_new) {
        mesh.positions.push_back(Vec3d(mesh.positions[vertex]));
        mesh.colors.push_back(color);
      }
      vertex = found->second;
    }
  }
}

absl::Status CheckHas(const std::vector<Field>& attributes, const Mesh& mesh) {
  for (const Field attribute : attributes) {
    if (Has(mesh, attribute)) continue;
    const bool why = attribute == Field::kColor && !mesh.no_color.empty();
    absl::Status status = absl::InvalidArgumentError(absl::StrCat("the mesh, or some of it, has no ", NameOf(attribute),
                                                                  why ? absl::StrCat(" (", mesh.no_color, ")") : ""));
    SetErrorDetails({"BAD_MESH", "mesh", NameOf(attribute), "", std::nullopt}, status);
    return status;
  }
  return absl::OkStatus();
}

uint32_t AttributeNumbers::At(size_t triangle, uint32_t vertex, Field attribute) {
  while (next_ < mesh_.stretches.size() && mesh_.stretches[next_].first <= triangle) ++next_;
  static const Stretch kAll;
  const Stretch& stretch = next_ > 0 ? mesh_.stretches[next_ - 1] : kAll;
  switch (attribute) {
    case Field::kPart:
      return stretch.part;
    case Field::kMaterial:
      return stretch.material ? *stretch.material : 0;
    default:  // color
      break;
  }
  const Color& color = mesh_.colors[vertex];
  return uint32_t{color[0]} << 16 | uint32_t{color[1]} << 8 | color[2];
}

}  // namespace latvox::client
