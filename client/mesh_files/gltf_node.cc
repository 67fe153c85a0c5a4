#include "client/mesh_files/gltf_node.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "client/mesh_files/bad.h"
#include "client/mesh_files/gltf_accessor.h"

namespace latvox::client {
namespace {

constexpr char kInstancing[] = "EXT_mesh_gpu_instancing";

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

struct Parts {
  Vec3d translation{};
  std::array<double, 4> rotation{0, 0, 0, 1};  // a quaternion x, y, z, w, which may not be exactly a unit
  Vec3d scale{1, 1, 1};
};

// Applies scale, then rotation, then translation. Returns false if the rotation is 0.
bool Join(const Parts& parts, Affine& place) {
  const auto [x, y, z, w] = parts.rotation;
  const auto& [t, q, s] = parts;
  const double norm = x * x + y * y + z * z + w * w;
  if (norm == 0) return false;
  const double k = 2 / norm;
  place = {{{1 - k * (y * y + z * z), k * (x * y - z * w), k * (x * z + y * w), t[0]},
            {k * (x * y + z * w), 1 - k * (x * x + z * z), k * (y * z - x * w), t[1]},
            {k * (x * z - y * w), k * (y * z + x * w), 1 - k * (x * x + y * y), t[2]}}};
  for (auto& row : place) {
    for (size_t c = 0; c < 3; ++c) row[c] *= s[c];
  }
  return true;
}

// Numbers of the instances; empty: not given.
using InstanceNumbers = absl::StatusOr<std::vector<double>>;

InstanceNumbers ReadInstanceNumbers(const SortedJson& attributes, const char* name, size_t components,
                                    const SortedJson& root, GltfBuffers& buffers) {
  if (!attributes.contains(name)) return std::vector<double>();
  const auto accessor = GltfIndex(attributes, name, root, "accessors");
  if (!accessor.ok()) return accessor.status();
  auto numbers = ReadGltfNumbers(*accessor, root, buffers);
  if (!numbers.ok()) return numbers.status();
  if (numbers->components == components) return std::move(numbers->values);
  return Bad(name, " has ", numbers->components, " components, not ", components);
}

// Writes the numbers of instance n to a part, if they are given.
template <size_t kCount>
void Take(const InstanceNumbers& numbers, size_t n, std::array<double, kCount>& part) {
  if (!numbers->empty()) std::copy_n(numbers->begin() + static_cast<std::ptrdiff_t>(n * kCount), kCount, part.begin());
}

absl::StatusOr<std::vector<Affine>> ReadInstances(const SortedJson& attributes, const SortedJson& root,
                                                  GltfBuffers& buffers) {
  const auto translations = ReadInstanceNumbers(attributes, "TRANSLATION", 3, root, buffers);
  const auto rotations = ReadInstanceNumbers(attributes, "ROTATION", 4, root, buffers);
  const auto scales = ReadInstanceNumbers(attributes, "SCALE", 3, root, buffers);
  size_t count = 0;
  for (const auto* numbers : {&translations, &rotations, &scales}) {
    if (!numbers->ok()) return numbers->status();
    if ((*numbers)->empty()) continue;
    const size_t own = (*numbers)->size() / (numbers == &rotations ? 4 : 3);
    if (count != 0 && own != count) return Bad("its attributes have ", count, " and ", own, " elements");
    count = own;
  }
  if (count == 0) return std::vector<Affine>{kIdentity};
  std::vector<Affine> places(count);
  for (size_t n = 0; n < count; ++n) {
    Parts parts;
    Take(translations, n, parts.translation);
    Take(rotations, n, parts.rotation);
    Take(scales, n, parts.scale);
    if (!Join(parts, places[n])) return Bad("ROTATION ", n, " is 0");
  }
  return places;
}

}  // namespace

absl::StatusOr<Affine> GltfPlaceOf(const SortedJson& node) {
  Affine place;
  if (node.contains("matrix")) {
    const auto columns = Numbers<16>(node, "matrix", {});
    if (!columns.ok()) return columns.status();
    for (size_t r = 0; r < 3; ++r) {
      for (size_t c = 0; c < 4; ++c) place[r][c] = (*columns)[4 * c + r];
    }
    return place;
  }
  const Parts none;
  const auto t = Numbers(node, "translation", none.translation), s = Numbers(node, "scale", none.scale);
  const auto q = Numbers(node, "rotation", none.rotation);
  if (!t.ok() || !s.ok()) return t.ok() ? s.status() : t.status();
  if (!q.ok()) return q.status();
  if (!Join({*t, *q, *s}, place)) return Bad("rotation is 0");
  return place;
}

absl::Status GltfWorldPlaces::FindParents() {
  const SortedJson& nodes = root_.at("nodes");
  parents_.resize(nodes.size());
  for (size_t parent = 0; parent < nodes.size(); ++parent) {
    for (const SortedJson& each : nodes[parent].value("children", SortedJson::array())) {
      const auto child = GltfElement(each, "children", root_, "nodes");
      if (!child.ok()) return Bad("nodes[", parent, "]: ", child.status().message());
      if (parents_[*child]) return Bad("nodes[", *child, "] has two parents");
      parents_[*child] = parent;
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<Affine> GltfWorldPlaces::Of(uint64_t node) {
  if (parents_.empty()) {
    if (auto status = FindParents(); !status.ok()) return status;
  }
  std::vector<uint64_t> open;  // the node and its ancestors up to one that is placed
  std::optional<uint64_t> next = node;
  for (; next && !places_.contains(*next); next = parents_[*next]) {
    if (open.size() > parents_.size()) return Bad("nodes[", node, "] is among its own ancestors");
    open.push_back(*next);
  }
  Affine place = next ? places_.at(*next) : outer_;
  for (; !open.empty(); open.pop_back()) {
    const auto own = GltfPlaceOf(root_.at("nodes").at(open.back()));
    if (!own.ok()) return Bad("nodes[", open.back(), "]: ", own.status().message());
    place = place * *own;
    places_.emplace(open.back(), place);
  }
  return place;
}

absl::StatusOr<std::vector<Affine>> ReadGltfInstances(const SortedJson& node, const SortedJson& root,
                                                      GltfBuffers& buffers) {
  const SortedJson extensions = node.value("extensions", SortedJson::object());
  const auto instancing = extensions.find(kInstancing);
  if (instancing == extensions.end()) return std::vector<Affine>{kIdentity};
  auto places = ReadInstances(instancing->at("attributes"), root, buffers);
  if (!places.ok())
    return absl::Status(places.status().code(), absl::StrCat(kInstancing, ": ", places.status().message()));
  return places;
}

}  // namespace latvox::client
