#include "client/mesh_files/obj_texture.h"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/mesh/srgb.h"
#include "client/mesh_files/input.h"
#include "client/mesh_files/number_text.h"
#include "client/mesh_files/obj_statements.h"
#include "client/mesh_files/polygon.h"

namespace latvox::client {
namespace {

constexpr float kNotGiven = std::numeric_limits<float>::quiet_NaN();

using Image = std::shared_ptr<EncodedImage>;

absl::StatusOr<Image> ReadImage(const MtlTexture& texture) {
  const auto path = FindFile(texture.name, texture.folder);
  if (!path) return absl::InvalidArgumentError(absl::StrCat("texture file \"", texture.name, "\" does not exist"));
  auto bytes = ReadBytes(*path);
  if (!bytes.ok()) return bytes.status();
  return std::make_shared<EncodedImage>(EncodedImage{*path, *std::move(bytes)});
}

// The base colors of materials, read when they are first needed.
class MtlBaseColors {
 public:
  MtlBaseColors(const MtlMaterials& materials, BadElements& bad, std::vector<BaseColor>& all)
      : materials_(materials), bad_(bad), all_(all) {}

  // Returns the number of the material's base color; kNone without a texture.
  absl::StatusOr<uint32_t> Of(const std::string& material) {
    const auto texture = materials_.textures.find(material);
    if (texture == materials_.textures.end()) return TriangleBaseColor::kNone;
    const auto [found, is_new] = numbers_.try_emplace(material, TriangleBaseColor::kNone);
    if (!is_new) return found->second;
    auto image = ReadImage(texture->second);
    if (!image.ok()) {
      const std::string element = absl::StrCat("material \"", material, "\"");
      const auto error = absl::InvalidArgumentError(absl::StrCat(element, ": ", image.status().message()));
      if (auto status = bad_.Add(error, element); !status.ok()) return status;
      return found->second;
    }
    found->second = static_cast<uint32_t>(all_.size());
    const Wrap wrap = texture->second.clamps ? Wrap::kClamp : Wrap::kRepeat;
    all_.push_back({FactorOf(material), *std::move(image), {wrap, wrap}});
    return found->second;
  }

 private:
  LinearRgba FactorOf(const std::string& material) const {
    LinearRgba factor{1, 1, 1, 1};
    const auto color = materials_.colors.find(material);
    if (color == materials_.colors.end()) return factor;
    for (size_t n = 0; n < 3; ++n) factor[n] = static_cast<float>(ToLinear(color->second[n]));
    return factor;
  }

  const MtlMaterials& materials_;
  BadElements& bad_;
  std::vector<BaseColor>& all_;
  std::map<std::string, uint32_t> numbers_;
};

// Turns the places of a file, whose v points up, into those of an image.
void Move(const MtlTexture& texture, TriangleBaseColor& triangle) {
  for (auto& [u, v] : triangle.corners) {
    u = static_cast<float>(u * texture.scale[0] + texture.offset[0]);
    v = static_cast<float>(1 - (v * texture.scale[1] + texture.offset[1]));
  }
}

bool HasPlaces(const TriangleBaseColor& triangle) {
  for (const auto& [u, v] : triangle.corners) {
    if (!std::isfinite(u) || !std::isfinite(v)) return false;
  }
  return true;
}

}  // namespace

ObjTexturePoints::ObjTexturePoints(absl::string_view text) {
  ObjStatements statements(text);
  for (absl::string_view words; statements.Next(words);) {
    if (TakeWord(words) != "vt") continue;
    double u = 0, v = 0;
    const bool is_point = ParseDouble(TakeWord(words), u);
    ParseDouble(TakeWord(words), v);  // a texture along a line has only u
    points_.push_back(is_point ? ImagePoint{static_cast<float>(u), static_cast<float>(v)}
                               : ImagePoint{kNotGiven, kNotGiven});
  }
}

absl::StatusOr<ImagePoint> ObjTexturePoints::Of(absl::string_view corner, size_t line) const {
  const size_t slash = corner.find('/');
  if (slash == absl::string_view::npos) return ImagePoint{kNotGiven, kNotGiven};
  const absl::string_view rest = corner.substr(slash + 1), number = rest.substr(0, rest.find('/'));
  if (number.empty()) return ImagePoint{kNotGiven, kNotGiven};
  int64_t index = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), index);
  const int64_t from_zero = index > 0 ? index - 1 : static_cast<int64_t>(passed_) + index;
  const bool is_number = error == std::errc() && end == number.data() + number.size() && index != 0;
  if (!is_number || from_zero < 0 || from_zero >= static_cast<int64_t>(points_.size())) {
    return LineError(line, "texture index \"", number, "\" of a face is not within the file's ", points_.size(),
                     " texture coordinates");
  }
  return points_[static_cast<size_t>(from_zero)];
}

void TriangulateWithPlaces(const std::vector<uint32_t>& polygon, const std::vector<ImagePoint>& places, Mesh& mesh) {
  std::vector<uint32_t> corners(polygon.size());
  std::iota(corners.begin(), corners.end(), 0);
  std::vector<Vec3d> positions;
  for (const uint32_t vertex : polygon) positions.push_back(mesh.positions[vertex]);
  std::vector<std::array<uint32_t, 3>> triangles;
  Triangulate(corners, positions, triangles);
  for (const auto& [a, b, c] : triangles) {
    mesh.triangles.push_back({polygon[a], polygon[b], polygon[c]});
    mesh.base_colors.triangles.push_back({TriangleBaseColor::kNone, {places[a], places[b], places[c]}});
  }
}

absl::Status ApplyTextures(const MtlMaterials& materials, const std::vector<std::string>& of_material, BadElements& bad,
                           Mesh& mesh) {
  BaseColors& colors = mesh.base_colors;
  MtlBaseColors base_colors(materials, bad, colors.all);
  size_t without = 0;
  for (size_t s = 0; s < mesh.stretches.size(); ++s) {
    const auto& [first, part, material] = mesh.stretches[s];
    if (!material || *material >= of_material.size()) continue;
    const std::string& name = of_material[*material];
    const auto number = base_colors.Of(name);
    if (!number.ok()) return number.status();
    if (*number == TriangleBaseColor::kNone) continue;
    const size_t end = s + 1 < mesh.stretches.size() ? mesh.stretches[s + 1].first : mesh.triangles.size();
    for (size_t t = first; t < end; ++t) {
      TriangleBaseColor& triangle = colors.triangles[t];
      if (!HasPlaces(triangle)) {
        ++without;
        continue;
      }
      triangle.number = *number;
      Move(materials.textures.at(name), triangle);
    }
  }
  if (colors.all.empty()) colors = {};
  if (without > 0) {
    mesh.warnings.push_back({"IGNORED_TEXTURE", absl::StrCat(without,
                                                             " triangles of materials with textures have no "
                                                             "texture coordinates; their color is Kd")});
  }
  return absl::OkStatus();
}

}  // namespace latvox::client
