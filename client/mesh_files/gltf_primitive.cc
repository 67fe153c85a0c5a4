#include "client/mesh_files/gltf_primitive.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "client/mesh_files/bad.h"
#include "client/mesh_files/draco_file.h"
#include "client/mesh_files/gltf_accessor.h"
#include "client/mesh_files/gltf_color.h"

namespace latvox::client {
namespace {

enum Mode : uint64_t { kPoints, kLines, kLineLoop, kLineStrip, kTriangles, kStrip, kFan };

// Returns the number of points or lines with this number of corners.
uint64_t PointsOrLines(Mode mode, uint64_t corners) {
  if (mode == kLines) return corners / 2;
  return mode == kLineStrip && corners > 0 ? corners - 1 : corners;
}

// Returns the corners of triangle t. All triangles have one orientation.
std::array<size_t, 3> CornersOf(Mode mode, size_t t) {
  if (mode == kTriangles) return {3 * t, 3 * t + 1, 3 * t + 2};
  if (mode == kFan) return {t + 1, t + 2, 0};
  return {t, t + 1 + t % 2, t + 2 - t % 2};
}

absl::Status AppendTriangles(Mode mode, const std::vector<uint32_t>& corners, BadElements& bad, Mesh& mesh) {
  const size_t count = corners.size();
  if (mode == kTriangles && count % 3 != 0) {
    return Bad(count, " corners of triangles are not a multiple of 3");
  }
  const size_t triangles = mode == kTriangles ? count / 3 : count < 3 ? 0 : count - 2;
  for (size_t t = 0; t < triangles; ++t) {
    std::array<uint32_t, 3> triangle;
    for (size_t n = 0; n < 3; ++n) triangle[n] = corners[CornersOf(mode, t)[n]];
    const auto beyond = std::find_if(triangle.begin(), triangle.end(),
                                     [&](uint32_t vertex) { return vertex >= mesh.positions.size(); });
    if (beyond == triangle.end()) {
      mesh.triangles.push_back(triangle);
      continue;
    }
    const absl::Status error =
        Bad("vertex index ", *beyond, " of triangle ", t, " is not within the ", mesh.positions.size(), " vertices");
    if (auto status = bad.Add(error, absl::StrCat("triangle ", t)); !status.ok()) return status;
  }
  return absl::OkStatus();
}

absl::Status StorePositions(uint64_t accessor, const SortedJson& root, GltfBuffers& buffers, Mesh& mesh) {
  const auto positions = ReadGltfNumbers(accessor, root, buffers);
  if (!positions.ok()) return positions.status();
  if (positions->components != 3) return Bad("POSITION has ", positions->components, " components, not 3");
  mesh.positions.resize(positions->values.size() / 3);
  for (size_t v = 0; v < mesh.positions.size(); ++v) {
    for (size_t n = 0; n < 3; ++n) mesh.positions[v][n] = positions->values[3 * v + n];
  }
  return absl::OkStatus();
}

// Multiplies the numbers of COLOR_0, red, green, blue and perhaps alpha, with the factor.
absl::Status StoreColors(const GltfNumbers& numbers, const LinearColor& factor, Mesh& mesh) {
  const size_t components = numbers.components, count = numbers.values.size() / components;
  if (components < 3 || count != mesh.positions.size()) {
    return Bad("COLOR_0 has ", count, " elements of ", components, " components, not ", mesh.positions.size(),
               " of 3 or 4");
  }
  for (size_t v = 0; v < count; ++v) {
    const double* const rgb = &numbers.values[components * v];
    mesh.colors.push_back(ToSrgb({rgb[0] * factor[0], rgb[1] * factor[1], rgb[2] * factor[2]}));
  }
  return absl::OkStatus();
}

bool IsAttributeRead(absl::string_view attribute) {
  constexpr absl::string_view kBeginnings[] = {"COLOR_0", "JOINTS_", "WEIGHTS_", "TEXCOORD_"};
  return std::any_of(std::begin(kBeginnings), std::end(kBeginnings),
                     [&](absl::string_view beginning) { return absl::StartsWith(attribute, beginning); });
}

// Reads attributes of the vertices, from the Draco stream if that has them, otherwise from accessors.
class VertexAttributes {
 public:
  VertexAttributes(const SortedJson& primitive, const SortedJson& root, GltfBuffers& buffers)
      : attributes_(primitive.at("attributes")), root_(root), buffers_(buffers) {}

  // Decodes the stream, with the attributes that are read later. Returns positions and triangles.
  absl::StatusOr<Mesh> Decode(const SortedJson& extension) {
    const SortedJson& ids = extension.at("attributes");
    const auto bytes = buffers_.View(extension);
    const auto positions = GltfNumber(ids, "POSITION");
    if (!bytes.ok() || !positions.ok()) return bytes.ok() ? positions.status() : bytes.status();
    DracoIds wanted{.positions = static_cast<uint32_t>(*positions)};
    std::vector<std::string> names;
    for (const auto& [name, id] : ids.items()) {
      if (!IsAttributeRead(name)) continue;
      const auto number = GltfNumber(ids, name.c_str());
      if (!number.ok()) return number.status();
      names.push_back(name);
      wanted.numbers.push_back(static_cast<uint32_t>(*number));
    }
    std::vector<DracoNumbers> numbers;
    auto mesh = ParseDraco(*bytes, wanted, &numbers);
    if (!mesh.ok()) {
      return absl::Status(mesh.status().code(), absl::StrCat("KHR_draco_mesh_compression: ", mesh.status().message()));
    }
    for (size_t n = 0; n < names.size(); ++n) {
      const double full = names[n] == "COLOR_0" ? numbers[n].full : 1;
      for (double& number : numbers[n].values) number /= full;
      decoded_[names[n]] = {numbers[n].components, std::move(numbers[n].values)};
    }
    return mesh;
  }

  bool Has(const std::string& name) const { return attributes_.contains(name) || decoded_.contains(name); }

  absl::StatusOr<GltfNumbers> Read(const std::string& name) {
    if (const auto found = decoded_.find(name); found != decoded_.end()) return found->second;
    const auto accessor = GltfIndex(attributes_, name.c_str(), root_, "accessors");
    if (!accessor.ok()) return accessor.status();
    return ReadGltfNumbers(*accessor, root_, buffers_);
  }

 private:
  const SortedJson& attributes_;
  const SortedJson& root_;
  GltfBuffers& buffers_;
  std::map<std::string, GltfNumbers> decoded_;
};

absl::StatusOr<Mesh> ReadTriangles(Mode mode, const SortedJson& primitive, const SortedJson& root, GltfBuffers& buffers,
                                   BadElements& bad) {
  const auto position = GltfIndex(primitive.at("attributes"), "POSITION", root, "accessors");
  if (!position.ok()) return position.status();
  Mesh mesh;
  if (auto status = StorePositions(*position, root, buffers, mesh); !status.ok()) return status;
  std::vector<uint32_t> corners(mesh.positions.size());
  std::iota(corners.begin(), corners.end(), 0);
  if (primitive.contains("indices")) {
    const auto number = GltfIndex(primitive, "indices", root, "accessors");
    if (!number.ok()) return number.status();
    auto indices = ReadGltfIndices(*number, root, buffers);
    if (!indices.ok()) return indices.status();
    corners = *std::move(indices);
  }
  if (auto status = AppendTriangles(mode, corners, bad, mesh); !status.ok()) return status;
  return mesh;
}

absl::Status ReadInfluences(VertexAttributes& attributes, size_t vertices, std::vector<GltfInfluences>& sets) {
  constexpr size_t kMostSets = 8;
  for (;;) {
    const std::string number = absl::StrCat(sets.size()), joints = "JOINTS_" + number, weights = "WEIGHTS_" + number;
    if (!attributes.Has(joints) || !attributes.Has(weights)) return absl::OkStatus();
    if (sets.size() == kMostSets) return Bad(joints, " is beyond the limit of ", kMostSets, " sets");
    GltfInfluences& set = sets.emplace_back();
    for (const std::string& name : {joints, weights}) {
      auto read = attributes.Read(name);
      if (!read.ok()) return read.status();
      if (read->components != 4 || read->values.size() != 4 * vertices) {
        return Bad(name, " has ", read->values.size() / read->components, " elements of ", read->components,
                   " components, not ", vertices, " of 4");
      }
      (name == joints ? set.joints : set.weights) = std::move(read->values);
    }
  }
}

// Counts points or lines without reading their coordinates.
absl::StatusOr<Mesh> CountPointsOrLines(Mode mode, const SortedJson& primitive, const SortedJson& root) {
  const bool indexed = primitive.contains("indices");
  const SortedJson& named = indexed ? primitive : primitive.at("attributes");
  const auto number = GltfIndex(named, indexed ? "indices" : "POSITION", root, "accessors");
  if (!number.ok()) return number.status();
  const auto count = GltfNumber(root.at("accessors").at(*number), "count");
  if (!count.ok()) return Bad("accessors[", *number, "]: ", count.status().message());
  Mesh mesh;
  mesh.skipped = PointsOrLines(mode, *count);
  return mesh;
}

absl::Status ReadColors(const SortedJson& primitive, const SortedJson& root, VertexAttributes& attributes, Mesh& mesh) {
  const bool has_material = primitive.contains("material");
  if (has_material) {
    const auto material = GltfIndex(primitive, "material", root, "materials");
    if (!material.ok()) return material.status();
  }
  const LinearColor factor = GltfBaseColorOf(primitive, root).factor;
  if (!attributes.Has("COLOR_0")) {
    if (has_material) mesh.colors.assign(mesh.positions.size(), ToSrgb(factor));
    return absl::OkStatus();
  }
  const auto numbers = attributes.Read("COLOR_0");
  return numbers.ok() ? StoreColors(*numbers, factor, mesh) : numbers.status();
}

absl::Status ReadPlaces(const GltfTexture& texture, size_t count, VertexAttributes& attributes,
                        std::vector<ImagePoint>& places) {
  const std::string name = absl::StrCat("TEXCOORD_", texture.set);
  if (!attributes.Has(name)) return Bad("the material has a texture, and the vertices have no ", name);
  const auto read = attributes.Read(name);
  if (!read.ok()) return read.status();
  const std::vector<double>& uv = read->values;
  if (read->components != 2 || uv.size() != 2 * count) {
    return Bad(name, " has ", uv.size() / read->components, " elements of ", read->components, " components, not ",
               count, " of 2");
  }
  for (size_t v = 0; v < count; ++v) places.push_back(texture.Apply(uv[2 * v], uv[2 * v + 1]));
  return absl::OkStatus();
}

// Reads COLOR_0 of as many vertices as the mesh has; see StoreColors.
absl::Status ReadVertexFactors(VertexAttributes& attributes, std::vector<LinearRgba>& factors) {
  const auto read = attributes.Read("COLOR_0");
  if (!read.ok()) return read.status();
  for (size_t at = 0; at < read->values.size(); at += read->components) {
    LinearRgba& factor = factors.emplace_back(LinearRgba{1, 1, 1, 1});
    for (size_t n = 0; n < std::min(read->components, factor.size()); ++n) {
      factor[n] = static_cast<float>(std::clamp(read->values[at + n], 0.0, 1.0));
    }
  }
  return absl::OkStatus();
}

absl::Status ReadBaseColors(const SortedJson& primitive, VertexAttributes& attributes, GltfTextures& textures,
                            GltfPrimitive& out) {
  const auto texture = textures.Of(primitive);
  if (!texture.ok()) return texture.status();
  GltfBaseColors colors{texture->color};
  if (attributes.Has("COLOR_0")) {
    if (auto status = ReadVertexFactors(attributes, colors.vertices); !status.ok()) return status;
  }
  const auto is_opaque = [](const LinearRgba& factor) { return factor[3] == 1; };
  const bool has_image = colors.color.image != nullptr;
  if (!has_image && is_opaque(colors.color.factor) &&
      std::all_of(colors.vertices.begin(), colors.vertices.end(), is_opaque)) {
    return absl::OkStatus();
  }
  if (has_image) {
    const absl::Status status = ReadPlaces(*texture, out.mesh.positions.size(), attributes, colors.places);
    if (!status.ok()) return status;
  }
  out.base_colors = std::move(colors);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<GltfPrimitive> ReadGltfPrimitive(const SortedJson& primitive, const GltfPose& pose,
                                                const SortedJson& root, GltfBuffers& buffers, BadElements& bad,
                                                GltfTextures* textures) {
  const auto number = GltfNumber(primitive, "mode", kTriangles);
  if (!number.ok()) return number.status();
  if (*number > kFan) return Bad("mode ", *number, " exceeds ", +kFan);
  const Mode mode{*number};
  if (!primitive.at("attributes").contains("POSITION")) return GltfPrimitive();
  if (mode < kTriangles) {
    auto counted = CountPointsOrLines(mode, primitive, root);
    if (!counted.ok()) return counted.status();
    return GltfPrimitive{*std::move(counted), {}};
  }
  VertexAttributes attributes(primitive, root, buffers);
  const SortedJson extensions = primitive.value("extensions", SortedJson::object());
  const auto draco = extensions.find("KHR_draco_mesh_compression");
  auto mesh =
      draco == extensions.end() ? ReadTriangles(mode, primitive, root, buffers, bad) : attributes.Decode(*draco);
  if (!mesh.ok()) return mesh.status();
  GltfPrimitive out{*std::move(mesh), {}};
  absl::Status status = ReadColors(primitive, root, attributes, out.mesh);
  if (status.ok() && textures != nullptr) status = ReadBaseColors(primitive, attributes, *textures, out);
  if (status.ok()) status = ApplyTargets(primitive, pose.weights, root, buffers, out.mesh.positions);
  if (status.ok() && pose.is_skinned) status = ReadInfluences(attributes, out.mesh.positions.size(), out.influences);
  if (!status.ok()) return status;
  return out;
}

}  // namespace latvox::client
