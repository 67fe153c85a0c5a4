#include "client/mesh_files/gltf_pose.h"

#include <cstddef>
#include <string>

#include "absl/strings/str_cat.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/bad.h"
#include "client/mesh_files/gltf_document.h"

namespace latvox::client {
namespace {

absl::Status ApplyTarget(uint64_t accessor, double weight, const SortedJson& root, GltfBuffers& buffers,
                         std::vector<Vec3d>& positions) {
  const auto moves = ReadGltfNumbers(accessor, root, buffers);
  if (!moves.ok()) return moves.status();
  if (moves->components != 3 || moves->values.size() != 3 * positions.size()) {
    return Bad("POSITION has ", moves->values.size() / moves->components, " elements of ", moves->components,
               " components, not ", positions.size(), " of 3");
  }
  for (size_t v = 0; v < positions.size(); ++v) {
    for (size_t n = 0; n < 3; ++n) positions[v][n] += weight * moves->values[3 * v + n];
  }
  return absl::OkStatus();
}

// The sum of weighted transforms.
struct Blend {
  Affine sum{};
  double weight = 0;

  void Add(const Affine& joint, double by) {
    weight += by;
    for (size_t r = 0; r < 3; ++r) {
      for (size_t c = 0; c < 4; ++c) sum[r][c] += by * joint[r][c];
    }
  }

  Affine Mean() const {
    Affine mean = sum;
    for (auto& row : mean) {
      for (double& number : row) number /= weight;
    }
    return mean;
  }
};

}  // namespace

absl::Status ApplyTargets(const SortedJson& primitive, const std::vector<double>& weights, const SortedJson& root,
                          GltfBuffers& buffers, std::vector<Vec3d>& positions) {
  const SortedJson targets = primitive.value("targets", SortedJson::array());
  size_t moved = 0;
  for (size_t t = 0; t < std::min(weights.size(), targets.size()); ++t) {
    if (weights[t] == 0 || !targets[t].contains("POSITION")) continue;
    moved += positions.size();
    if (moved > kMostPlaced) {
      return absl::ResourceExhaustedError(absl::StrCat("its targets move more than ", kMostPlaced, " vertices"));
    }
    const auto accessor = GltfIndex(targets[t], "POSITION", root, "accessors");
    const absl::Status status =
        accessor.ok() ? ApplyTarget(*accessor, weights[t], root, buffers, positions) : accessor.status();
    if (!status.ok()) return absl::Status(status.code(), absl::StrCat("targets[", t, "]: ", status.message()));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<Affine>> ReadGltfJoints(uint64_t skin, const SortedJson& root, GltfBuffers& buffers,
                                                   GltfWorldPlaces& places) {
  const SortedJson& described = root.at("skins").at(skin);
  std::vector<Affine> joints;
  for (const SortedJson& each : described.at("joints")) {
    const auto node = GltfElement(each, "joints", root, "nodes");
    if (!node.ok()) return node.status();
    const auto place = places.Of(*node);
    if (!place.ok()) return place.status();
    joints.push_back(*place);
  }
  if (!described.contains("inverseBindMatrices")) return joints;
  const auto accessor = GltfIndex(described, "inverseBindMatrices", root, "accessors");
  if (!accessor.ok()) return accessor.status();
  const auto matrices = ReadGltfNumbers(*accessor, root, buffers);
  if (!matrices.ok()) return matrices.status();
  if (matrices->components != 16 || matrices->values.size() < 16 * joints.size()) {
    return Bad("inverseBindMatrices has ", matrices->values.size(), " numbers, not 16 for each of the ", joints.size(),
               " joints");
  }
  for (size_t n = 0; n < joints.size(); ++n) {
    Affine inverse;
    for (size_t r = 0; r < 3; ++r) {
      for (size_t c = 0; c < 4; ++c) inverse[r][c] = matrices->values[16 * n + 4 * c + r];
    }
    joints[n] = joints[n] * inverse;
  }
  return joints;
}

absl::StatusOr<bool> ApplySkin(const std::vector<GltfInfluences>& sets, const std::vector<Affine>& joints,
                               std::vector<Vec3d>& positions) {
  bool mirrors = false;
  for (size_t v = 0; v < positions.size(); ++v) {
    Blend blend;
    for (const GltfInfluences& set : sets) {
      for (size_t n = 4 * v; n < 4 * v + 4; ++n) {
        const double joint = set.joints[n], weight = set.weights[n];
        if (!(weight >= 0)) return Bad("vertex ", v, " has a joint of weight ", weight);
        if (weight == 0) continue;
        if (!(joint < static_cast<double>(joints.size()))) {
          return Bad("vertex ", v, " has joint ", joint, ", which is not among the skin's ", joints.size());
        }
        blend.Add(joints[static_cast<size_t>(joint)], weight);
      }
    }
    const double first = sets[0].joints[4 * v];
    if (blend.weight == 0 && first < static_cast<double>(joints.size()))
      blend.Add(joints[static_cast<size_t>(first)], 1);
    const Affine mean = blend.weight == 0 ? kIdentity : blend.Mean();
    if (v == 0) mirrors = Mirrors(mean);
    positions[v] = Apply(mean, positions[v]);
  }
  return mirrors;
}

}  // namespace latvox::client
