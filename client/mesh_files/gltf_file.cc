#include "client/mesh_files/gltf_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/json/json.h"
#include "client/mesh/affine.h"
#include "client/mesh/mesh_attributes.h"
#include "client/mesh_files/bad.h"
#include "client/mesh_files/gltf_buffers.h"
#include "client/mesh_files/gltf_document.h"
#include "client/mesh_files/gltf_primitive.h"

// No assimp, although it has an importer: it crashes on skins without matrices and takes quantized positions for
// floats. It ignores required extensions and triangles with an index out of range, and its errors name no place.
namespace latvox::client {
namespace {

constexpr uint32_t kNoMaterial = UINT32_MAX;  // until all materials are numbered

// Adds the place to the status.
absl::Status In(absl::string_view list, size_t number, const absl::Status& status) {
  return absl::Status(status.code(), absl::StrCat(list, number, "]: ", status.message()));
}

// Reads kCount numbers of a node.
template <size_t kCount>
absl::StatusOr<std::array<double, kCount>> Numbers(const SortedJson& node, const char* name,
                                                   const std::array<double, kCount>& otherwise) {
  const auto found = node.find(name);
  if (found == node.end()) return otherwise;
  const auto is_number = [](const SortedJson& each) { return each.is_number(); };
  if (!found->is_array() || found->size() != kCount || !std::all_of(found->begin(), found->end(), is_number)) {
    return Bad(name, " is not ", kCount, " numbers");
  }
  return found->get<std::array<double, kCount>>();
}

// Applies scale, then rotation by the quaternion (x, y, z, w), which may not be exactly a unit, then translation.
absl::StatusOr<Affine> PlaceOfParts(const SortedJson& node) {
  const auto t = Numbers<3>(node, "translation", {0, 0, 0}), s = Numbers<3>(node, "scale", {1, 1, 1});
  const auto q = Numbers<4>(node, "rotation", {0, 0, 0, 1});
  if (!t.ok() || !s.ok()) return t.ok() ? s.status() : t.status();
  if (!q.ok()) return q.status();
  const auto [x, y, z, w] = *q;
  const double norm = x * x + y * y + z * z + w * w;
  if (norm == 0) return Bad("rotation is 0");
  const double k = 2 / norm;
  Affine place = {{{1 - k * (y * y + z * z), k * (x * y - z * w), k * (x * z + y * w), (*t)[0]},
                   {k * (x * y + z * w), 1 - k * (x * x + z * z), k * (y * z - x * w), (*t)[1]},
                   {k * (x * z - y * w), k * (y * z + x * w), 1 - k * (x * x + y * y), (*t)[2]}}};
  for (auto& row : place) {
    for (size_t c = 0; c < 3; ++c) row[c] *= (*s)[c];
  }
  return place;
}

absl::StatusOr<Affine> PlaceOf(const SortedJson& node) {
  if (!node.contains("matrix")) return PlaceOfParts(node);
  const auto columns = Numbers<16>(node, "matrix", {});
  if (!columns.ok()) return columns.status();
  Affine place;
  for (size_t r = 0; r < 3; ++r) {
    for (size_t c = 0; c < 4; ++c) place[r][c] = (*columns)[4 * c + r];
  }
  return place;
}

// Returns "" if there is no name.
std::string NameOf(const SortedJson& object) {
  const auto name = object.find("name");
  return name != object.end() && name->is_string() ? name->get<std::string>() : "";
}

std::string NameOfMaterial(const SortedJson& material, uint64_t number) {
  const std::string name = material.value("name", "");
  return name.empty() ? absl::StrCat("materials[", number, "]") : absl::StrCat("material \"", name, "\"");
}

// Returns the color of a whole part: the factor of its material. With a texture there is no single color: then returns
// nothing and writes the reason to no_color.
std::optional<Color> BaseColorOf(uint64_t number, const SortedJson& root, std::string& no_color) {
  const SortedJson& material = root.at("materials").at(number);
  const SortedJson none = SortedJson::object(), extensions = material.value("extensions", none);
  const bool specular = extensions.contains("KHR_materials_pbrSpecularGlossiness");
  const SortedJson look =
      specular ? extensions.at("KHR_materials_pbrSpecularGlossiness") : material.value("pbrMetallicRoughness", none);
  if (look.contains(specular ? "diffuseTexture" : "baseColorTexture")) {
    no_color = absl::StrCat(NameOfMaterial(material, number), " has a texture, and textures are not sampled");
    return std::nullopt;
  }
  return ToColor(look.value(specular ? "diffuseFactor" : "baseColorFactor", std::array<float, 4>{1, 1, 1, 1}).data());
}

class SceneReader {
 public:
  SceneReader(const GltfDocument& document, const std::filesystem::path& folder, size_t most)
      : root_(document.root), most_(most), buffers_(document, folder) {}

  // Errors: also exceptions of the JSON library.
  absl::StatusOr<Mesh> Read();

 private:
  // A node and the transform of its ancestors.
  struct Visit {
    uint64_t node;
    Affine parent;
  };

  absl::Status Push(const SortedJson& owner, const char* list, const Affine& parent);
  absl::Status Add(const Visit& visit);
  absl::Status AddMesh(uint64_t number, const std::string& node_name, const Affine& to_world);
  absl::Status AddPrimitive(const SortedJson& described, const Mesh& primitive, uint32_t part, const Affine& to_world);
  absl::Status CheckSize(size_t triangles, size_t vertices) const;
  absl::StatusOr<std::vector<Mesh>> ReadPrimitives(const SortedJson& mesh);
  absl::StatusOr<uint32_t> NumberOfMaterial(const SortedJson& primitive);
  void WarnOfWeights(const SortedJson& node);

  const SortedJson& root_;
  const size_t most_;  // limit of triangles, and of vertices
  GltfBuffers buffers_;
  std::vector<Visit> open_;                       // a stack
  std::vector<bool> seen_;                        // for each node
  std::map<uint64_t, std::vector<Mesh>> meshes_;  // primitives of the meshes placed so far
  std::map<uint64_t, uint32_t> materials_;        // glTF index to our number
  Mesh mesh_;
};

absl::StatusOr<Mesh> SceneReader::Read() {
  const auto number = GltfIndex(root_, "scene", root_, "scenes", 0);
  if (!number.ok()) return number.status();
  seen_.resize(root_.value("nodes", SortedJson::array()).size());
  if (auto status = Push(root_.at("scenes").at(*number), "nodes", kIdentity); !status.ok()) {
    return Bad("scenes[", *number, "]: ", status.message());
  }
  while (!open_.empty()) {
    const Visit visit = open_.back();
    open_.pop_back();
    if (auto status = Add(visit); !status.ok()) return status;
  }
  mesh_.materials = static_cast<uint32_t>(materials_.size());
  bool bare = false;
  for (Stretch& stretch : mesh_.stretches) {
    if (stretch.material != kNoMaterial) continue;
    stretch.material = mesh_.materials;
    bare = true;
  }
  mesh_.materials += bare;
  return std::move(mesh_);
}

// Opens the nodes of a list in its order. A node may be visited only once, because nodes form trees.
absl::Status SceneReader::Push(const SortedJson& owner, const char* list, const Affine& parent) {
  const size_t begin = open_.size();
  for (const SortedJson& each : owner.value(list, SortedJson::array())) {
    const auto node = GltfElement(each, list, root_, "nodes");
    if (!node.ok()) return node.status();
    if (seen_[*node]) return Bad(list, " ", *node, " is in the scene already");
    seen_[*node] = true;
    open_.push_back({*node, parent});
  }
  std::reverse(open_.begin() + static_cast<std::ptrdiff_t>(begin), open_.end());
  return absl::OkStatus();
}

absl::Status SceneReader::Add(const Visit& visit) {
  const auto named = [&](const absl::Status& status) { return Bad("nodes[", visit.node, "]: ", status.message()); };
  const SortedJson& node = root_.at("nodes").at(visit.node);
  const auto place = PlaceOf(node);
  if (!place.ok()) return named(place.status());
  const Affine to_world = visit.parent * *place;
  if (node.contains("mesh")) {
    const auto number = GltfIndex(node, "mesh", root_, "meshes");
    if (!number.ok()) return named(number.status());
    WarnOfWeights(node);
    if (auto status = AddMesh(*number, NameOf(node), to_world); !status.ok()) return status;
  }
  if (auto status = Push(node, "children", to_world); !status.ok()) return named(status);
  return absl::OkStatus();
}

absl::Status SceneReader::CheckSize(size_t triangles, size_t vertices) const {
  if (std::max(triangles, vertices) <= most_) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat("the scene has more than ", most_, " triangles or vertices"));
}

absl::StatusOr<std::vector<Mesh>> SceneReader::ReadPrimitives(const SortedJson& mesh) {
  std::vector<Mesh> primitives;
  size_t triangles = mesh_.triangles.size(), vertices = mesh_.positions.size();
  for (const SortedJson& described : mesh.at("primitives")) {
    absl::StatusOr<Mesh> primitive;
    try {
      primitive = ReadGltfPrimitive(described, root_, buffers_);
    } catch (const SortedJson::exception& error) {
      primitive = GltfError(error);
    }
    const absl::Status& status = primitive.status();
    if (!status.ok()) return In("primitives[", primitives.size(), status);
    if (primitive->triangles.empty()) {  // its vertices are not needed
      primitive->positions = {};
      primitive->colors = {};
    }
    triangles += primitive->triangles.size();
    vertices += primitive->positions.size();
    if (auto enough = CheckSize(triangles, vertices); !enough.ok()) return enough;
    primitives.push_back(*std::move(primitive));
  }
  return primitives;
}

absl::Status SceneReader::AddMesh(uint64_t number, const std::string& node_name, const Affine& to_world) {
  const SortedJson& mesh = root_.at("meshes").at(number);
  const auto [found, is_new] = meshes_.try_emplace(number);
  const auto named = [&](const absl::Status& status) {
    return absl::Status(status.code(), absl::StrCat("meshes[", number, "].", status.message()));
  };
  if (is_new) {
    auto primitives = ReadPrimitives(mesh);
    if (!primitives.ok()) return named(primitives.status());
    found->second = *std::move(primitives);
  }
  const uint32_t part = NextPart(mesh_);
  SetName(part, node_name.empty() ? NameOf(mesh) : node_name, mesh_.part_names);
  for (size_t n = 0; n < found->second.size(); ++n) {
    const absl::Status status = AddPrimitive(mesh.at("primitives").at(n), found->second[n], part, to_world);
    if (!status.ok()) return named(In("primitives[", n, status));
  }
  return absl::OkStatus();
}

absl::Status SceneReader::AddPrimitive(const SortedJson& described, const Mesh& primitive, uint32_t part,
                                       const Affine& to_world) {
  mesh_.skipped += primitive.skipped;
  if (primitive.triangles.empty()) return absl::OkStatus();
  const size_t base = mesh_.positions.size(), vertices = primitive.positions.size();
  if (auto status = CheckSize(mesh_.triangles.size() + primitive.triangles.size(), base + vertices); !status.ok()) {
    return status;
  }
  for (size_t v = 0; v < vertices; ++v) {
    const Vec3d position = Apply(to_world, primitive.positions[v]);
    for (const double coordinate : position) {
      if (!std::isfinite(coordinate)) return Bad("vertex ", v, " is not finite (", coordinate, ")");
    }
    mesh_.positions.push_back(position);
  }
  const auto material = NumberOfMaterial(described);
  if (!material.ok()) return material.status();
  if (mesh_.colors.size() == base && !primitive.colors.empty()) {
    mesh_.colors.insert(mesh_.colors.end(), primitive.colors.begin(), primitive.colors.end());
  } else if (mesh_.colors.size() == base && *material != kNoMaterial) {
    const auto color = BaseColorOf(GltfNumber(described, "material").value(), root_, mesh_.no_color);
    if (color) mesh_.colors.insert(mesh_.colors.end(), vertices, *color);
  }
  BeginStretch(part, *material, mesh_);
  for (auto triangle : primitive.triangles) {
    for (uint32_t& vertex : triangle) vertex += static_cast<uint32_t>(base);
    mesh_.triangles.push_back(triangle);
  }
  return absl::OkStatus();
}

absl::StatusOr<uint32_t> SceneReader::NumberOfMaterial(const SortedJson& primitive) {
  if (!primitive.contains("material")) return kNoMaterial;
  const auto material = GltfIndex(primitive, "material", root_, "materials");
  if (!material.ok()) return material.status();
  const uint32_t ours = materials_.try_emplace(*material, static_cast<uint32_t>(materials_.size())).first->second;
  SetName(ours, NameOf(root_.at("materials").at(*material)), mesh_.material_names);
  return ours;
}

void SceneReader::WarnOfWeights(const SortedJson& node) {
  const SortedJson& mesh = root_.at("meshes").at(node.at("mesh").get<size_t>());
  const SortedJson weights = (node.contains("weights") ? node : mesh).value("weights", SortedJson::array());
  const auto moves = [](const SortedJson& weight) { return weight != 0; };
  if (mesh_.warnings.empty() && std::any_of(weights.begin(), weights.end(), moves)) {
    const std::string element = absl::StrCat("meshes[", node.at("mesh").dump(), "]");
    mesh_.warnings.push_back(
        {"MORPH_TARGETS",
         absl::StrCat(element, " has morph targets of weights ", weights.dump(), ", which are not applied"), element});
  }
}

}  // namespace

absl::StatusOr<Mesh> ParseGltf(absl::string_view bytes, const std::filesystem::path& folder, size_t most) try {
  const auto document = ParseGltfDocument(bytes);
  if (!document.ok()) return document.status();
  return SceneReader(*document, folder, most).Read();
} catch (const SortedJson::exception& error) {
  return GltfError(error);
}

}  // namespace latvox::client
