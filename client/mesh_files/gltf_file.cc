#include "client/mesh_files/gltf_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/json/json.h"
#include "client/mesh/affine.h"
#include "client/mesh/mesh_attributes.h"
#include "client/mesh_files/bad.h"
#include "client/mesh_files/bad_elements.h"
#include "client/mesh_files/gltf_buffers.h"
#include "client/mesh_files/gltf_color.h"
#include "client/mesh_files/gltf_document.h"
#include "client/mesh_files/gltf_node.h"
#include "client/mesh_files/gltf_pose.h"
#include "client/mesh_files/gltf_primitive.h"
#include "client/mesh_files/gltf_texture.h"

// No assimp, although it has an importer: it crashes on skins without matrices and takes quantized positions for
// floats. It ignores required extensions and triangles with an index out of range, and its errors name no place.
namespace latvox::client {
namespace {

constexpr LinearRgba kFullColor{1, 1, 1, 1};
constexpr uint32_t kNoMaterial = UINT32_MAX;  // until all materials are numbered

// Returns the status with the element of a list before its message: "primitives[2]: ...".
absl::Status In(absl::string_view list, size_t number, const absl::Status& status) {
  return absl::Status(status.code(), absl::StrCat(list, "[", number, "]: ", status.message()));
}

// Returns the translation that CESIUM_RTC applies to the whole scene.
absl::StatusOr<Affine> OriginOf(const SortedJson& root) {
  const SortedJson extensions = root.value("extensions", SortedJson::object());
  const auto rtc = extensions.find("CESIUM_RTC");
  if (rtc == extensions.end()) return kIdentity;
  const auto place = GltfPlaceOf({{"translation", rtc->at("center")}});
  if (!place.ok()) return Bad("extensions.CESIUM_RTC: center is not 3 numbers");
  return place;
}

// Returns "" if there is no name.
std::string NameOf(const SortedJson& object) {
  const auto name = object.find("name");
  return name != object.end() && name->is_string() ? name->get<std::string>() : "";
}

// Returns the weights of the morph targets, up to the last one that is not 0.
std::vector<double> WeightsOf(const SortedJson& node, const SortedJson& mesh) {
  auto weights = (node.contains("weights") ? node : mesh).value("weights", std::vector<double>());
  while (!weights.empty() && weights.back() == 0) weights.pop_back();
  return weights;
}

class SceneReader {
 public:
  SceneReader(const GltfDocument& document, const std::filesystem::path& folder, const ParseOptions& options,
              size_t most)
      : root_(document.root), most_(most), buffers_(document, folder), bad_(options) {
    mesh_.warnings = document.warnings;
    if (options.base_colors) textures_.emplace(root_, buffers_, bad_);
  }

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
  absl::StatusOr<std::vector<Affine>> JointsOf(const SortedJson& node);
  absl::Status AddMesh(uint64_t number, const std::string& node_name, const GltfPose& pose,
                       const std::vector<Affine>& joints, const Affine& to_world);
  absl::Status AddSkinned(const SortedJson& described, const GltfPrimitive& primitive,
                          const std::vector<Affine>& joints, uint32_t part);
  absl::Status AddPrimitive(const SortedJson& described, const GltfPrimitive& primitive, uint32_t part,
                            const Affine& to_world);
  absl::Status CheckSize(size_t triangles, size_t vertices) const;
  absl::StatusOr<std::vector<GltfPrimitive>> ReadPrimitives(const SortedJson& mesh, const GltfPose& pose);
  absl::StatusOr<uint32_t> NumberOfMaterial(const SortedJson& primitive);
  void AppendColors(const SortedJson& described, const Mesh& primitive);
  uint32_t NumberOfBaseColor(const SortedJson& described, const GltfPrimitive& primitive);
  void AppendBaseColor(uint32_t number, const GltfPrimitive& primitive, const std::array<uint32_t, 3>& corners);
  void FinishColors();
  void WarnOfAnimations();

  const SortedJson& root_;
  const size_t most_;  // limit of triangles, and of vertices
  GltfBuffers buffers_;
  BadElements bad_;
  std::vector<Visit> open_;                                                     // a stack
  std::vector<bool> seen_;                                                      // for each node
  std::optional<GltfWorldPlaces> places_;                                       // of joints
  std::map<std::pair<uint64_t, GltfPose>, std::vector<GltfPrimitive>> meshes_;  // placed so far
  std::map<uint64_t, uint32_t> materials_;                                      // glTF index to our number
  std::optional<GltfTextures> textures_;                                        // if base colors are read
  std::map<const SortedJson*, uint32_t> base_colors_;                           // of primitives
  std::set<std::string> textured_;                                              // materials with a warning
  size_t bare_ = 0, colored_ = 0;                                               // triangles without and with colors
  Mesh mesh_;
};

absl::StatusOr<Mesh> SceneReader::Read() {
  if (root_.value("scenes", SortedJson::array()).empty()) return Bad("the file has no scene");
  const auto number = GltfIndex(root_, "scene", root_, "scenes", 0);
  if (!number.ok()) return number.status();
  seen_.resize(root_.value("nodes", SortedJson::array()).size());
  const auto origin = OriginOf(root_);
  if (!origin.ok()) return origin.status();
  places_.emplace(root_, *origin);
  if (auto status = Push(root_.at("scenes").at(*number), "nodes", *origin); !status.ok()) {
    return Bad("scenes[", *number, "]: ", status.message());
  }
  WarnOfAnimations();
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
  FinishColors();
  RemoveNotFinite(mesh_);
  bad_.Report(mesh_);
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
  const auto place = GltfPlaceOf(node);
  if (!place.ok()) return named(place.status());
  const Affine to_world = visit.parent * *place;
  if (node.contains("mesh")) {
    const auto number = GltfIndex(node, "mesh", root_, "meshes");
    const auto instances = ReadGltfInstances(node, root_, buffers_);
    const auto joints = JointsOf(node);
    if (!number.ok() || !instances.ok()) return named(number.ok() ? instances.status() : number.status());
    if (!joints.ok()) return named(joints.status());
    const GltfPose pose{WeightsOf(node, root_.at("meshes").at(*number)), node.contains("skin")};
    for (const Affine& instance : *instances) {
      if (auto status = AddMesh(*number, NameOf(node), pose, *joints, to_world * instance); !status.ok()) return status;
    }
  }
  if (auto status = Push(node, "children", to_world); !status.ok()) return named(status);
  return absl::OkStatus();
}

// Returns the transforms of the joints of the node's skin; none without a skin.
absl::StatusOr<std::vector<Affine>> SceneReader::JointsOf(const SortedJson& node) {
  if (!node.contains("skin")) return std::vector<Affine>();
  const auto skin = GltfIndex(node, "skin", root_, "skins");
  if (!skin.ok()) return skin.status();
  if (node.value("extensions", SortedJson::object()).contains("EXT_mesh_gpu_instancing")) {
    return Bad("a skin together with EXT_mesh_gpu_instancing is not defined");
  }
  auto joints = ReadGltfJoints(*skin, root_, buffers_, *places_);
  if (!joints.ok()) return In("skins", *skin, joints.status());
  return joints;
}

absl::Status SceneReader::CheckSize(size_t triangles, size_t vertices) const {
  if (std::max(triangles, vertices) <= most_) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat("the scene has more than ", most_, " triangles or vertices"));
}

absl::StatusOr<std::vector<GltfPrimitive>> SceneReader::ReadPrimitives(const SortedJson& mesh, const GltfPose& pose) {
  std::vector<GltfPrimitive> primitives;
  size_t triangles = mesh_.triangles.size(), vertices = mesh_.positions.size();
  for (const SortedJson& described : mesh.at("primitives")) {
    absl::StatusOr<GltfPrimitive> primitive;
    try {
      primitive = ReadGltfPrimitive(described, pose, root_, buffers_, bad_, textures_ ? &*textures_ : nullptr);
    } catch (const SortedJson::exception& error) {
      primitive = GltfError(error);
    }
    const absl::Status& status = primitive.status();
    if (!status.ok()) return In("primitives", primitives.size(), status);
    Mesh& read = primitive->mesh;
    if (read.triangles.empty()) {  // its vertices are not needed
      read.positions = {};
      read.colors = {};
      primitive->base_colors.reset();
    }
    triangles += read.triangles.size();
    vertices += read.positions.size();
    if (auto enough = CheckSize(triangles, vertices); !enough.ok()) return enough;
    primitives.push_back(*std::move(primitive));
  }
  return primitives;
}

absl::Status SceneReader::AddMesh(uint64_t number, const std::string& node_name, const GltfPose& pose,
                                  const std::vector<Affine>& joints, const Affine& to_world) {
  const SortedJson& mesh = root_.at("meshes").at(number);
  const auto [found, is_new] = meshes_.try_emplace(std::pair(number, pose));
  const auto named = [&](const absl::Status& status) {
    return absl::Status(status.code(), absl::StrCat("meshes[", number, "].", status.message()));
  };
  if (is_new) {
    auto primitives = ReadPrimitives(mesh, pose);
    if (!primitives.ok()) return named(primitives.status());
    found->second = *std::move(primitives);
  }
  const auto is_rigid = [](const GltfPrimitive& p) { return !p.mesh.triangles.empty() && p.influences.empty(); };
  if (pose.is_skinned && is_new && std::any_of(found->second.begin(), found->second.end(), is_rigid)) {
    const std::string element = absl::StrCat("meshes[", number, "]");
    mesh_.warnings.push_back({"SKIN_WITHOUT_WEIGHTS",
                              absl::StrCat(element, " has no JOINTS_0 and WEIGHTS_0, and its skin has no effect"),
                              element});
  }
  const uint32_t part = NextPart(mesh_);
  SetName(part, node_name.empty() ? NameOf(mesh) : node_name, mesh_.part_names);
  for (size_t n = 0; n < found->second.size(); ++n) {
    const SortedJson& described = mesh.at("primitives").at(n);
    const GltfPrimitive& primitive = found->second[n];
    const absl::Status status = primitive.influences.empty() ? AddPrimitive(described, primitive, part, to_world)
                                                             : AddSkinned(described, primitive, joints, part);
    if (!status.ok()) return named(In("primitives", n, status));
  }
  return absl::OkStatus();
}

// The node's own place has no effect.
absl::Status SceneReader::AddSkinned(const SortedJson& described, const GltfPrimitive& primitive,
                                     const std::vector<Affine>& joints, uint32_t part) {
  GltfPrimitive posed = primitive;
  const auto mirrors = ApplySkin(primitive.influences, joints, posed.mesh.positions);
  if (!mirrors.ok()) return mirrors.status();
  if (*mirrors) {
    for (auto& triangle : posed.mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
  return AddPrimitive(described, posed, part, kIdentity);
}

absl::Status SceneReader::AddPrimitive(const SortedJson& described, const GltfPrimitive& read, uint32_t part,
                                       const Affine& to_world) {
  const Mesh& primitive = read.mesh;
  mesh_.skipped += primitive.skipped;
  if (primitive.triangles.empty()) return absl::OkStatus();
  const size_t base = mesh_.positions.size(), vertices = primitive.positions.size();
  if (auto status = CheckSize(mesh_.triangles.size() + primitive.triangles.size(), base + vertices); !status.ok()) {
    return status;
  }
  for (size_t v = 0; v < vertices; ++v) {
    const Vec3d position = Apply(to_world, primitive.positions[v]);
    if (!IsFinite(position)) {
      const absl::Status error = Bad("vertex ", v, " is not finite (", absl::StrJoin(position, " "), ")");
      if (auto status = bad_.Add(error, absl::StrCat("vertex ", v)); !status.ok()) return status;
    }
    mesh_.positions.push_back(position);
  }
  const auto material = NumberOfMaterial(described);
  if (!material.ok()) return material.status();
  AppendColors(described, primitive);
  BeginStretch(part, *material, mesh_);
  const bool mirrors = Mirrors(to_world);
  const uint32_t base_color = NumberOfBaseColor(described, read);
  for (auto triangle : primitive.triangles) {
    if (mirrors) std::swap(triangle[1], triangle[2]);
    const auto is_whole = [&](uint32_t vertex) { return IsFinite(mesh_.positions[base + vertex]); };
    if (!std::all_of(triangle.begin(), triangle.end(), is_whole)) continue;
    if (read.base_colors) AppendBaseColor(base_color, read, triangle);
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

// Returns the number of the primitive's base color, which is added when the primitive is first placed.
uint32_t SceneReader::NumberOfBaseColor(const SortedJson& described, const GltfPrimitive& primitive) {
  std::vector<BaseColor>& all = mesh_.base_colors.all;
  if (!primitive.base_colors) return TriangleBaseColor::kNone;
  const auto [found, is_new] = base_colors_.try_emplace(&described, static_cast<uint32_t>(all.size()));
  if (is_new) all.push_back(primitive.base_colors->color);
  return found->second;
}

// Gives the next triangle its base color. Its corners are vertices of the primitive.
void SceneReader::AppendBaseColor(uint32_t number, const GltfPrimitive& primitive,
                                  const std::array<uint32_t, 3>& corners) {
  const auto& [color, places, factors] = *primitive.base_colors;
  auto& triangles = mesh_.base_colors.triangles;
  auto& vertices = mesh_.base_colors.vertices;
  triangles.resize(mesh_.triangles.size());
  triangles.push_back({number, {}});
  if (!factors.empty()) vertices.resize(triangles.size(), {kFullColor, kFullColor, kFullColor});
  for (size_t n = 0; n < 3; ++n) {
    if (!places.empty()) triangles.back().corners[n] = places[corners[n]];
    if (!factors.empty()) vertices.back()[n] = factors[corners[n]];
  }
}

void SceneReader::AppendColors(const SortedJson& described, const Mesh& primitive) {
  const size_t triangles = primitive.triangles.size();
  (primitive.colors.empty() ? bare_ : colored_) += triangles;
  mesh_.colors.insert(mesh_.colors.end(), primitive.colors.begin(), primitive.colors.end());
  mesh_.colors.resize(mesh_.positions.size(), Color{255, 255, 255});
  if (textures_) return;
  const std::string textured = GltfBaseColorOf(described, root_).textured;
  if (textured.empty() || !textured_.insert(textured).second) return;
  mesh_.warnings.push_back({"TEXTURE_NOT_READ",
                            absl::StrCat(textured,
                                         " has a texture, which is not read; its color is the base color "
                                         "factor times the colors of vertices"),
                            textured});
}

void SceneReader::FinishColors() {
  if (colored_ == 0) mesh_.colors.clear();
  if (colored_ == 0 || bare_ == 0) return;
  mesh_.warnings.push_back(
      {"PARTIAL_COLORS",
       absl::StrCat(bare_, " of ", bare_ + colored_, " triangles have neither colors nor a material, and are white")});
}

void SceneReader::WarnOfAnimations() {
  const size_t count = root_.value("animations", SortedJson::array()).size();
  if (count > 0) mesh_.warnings.push_back({"ANIMATIONS", absl::StrCat(count, " animations are not applied")});
}

}  // namespace

absl::StatusOr<Mesh> ParseGltf(absl::string_view bytes, const std::filesystem::path& folder,
                               const ParseOptions& options, size_t most) try {
  const auto document = ParseGltfDocument(bytes);
  if (!document.ok()) return document.status();
  return SceneReader(*document, folder, options, most).Read();
} catch (const SortedJson::exception& error) {
  return GltfError(error);
}

}  // namespace latvox::client
