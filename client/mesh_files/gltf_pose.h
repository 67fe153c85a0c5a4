// The default pose of a glTF mesh: morph targets by their weights, then the skin.
#ifndef LATVOX_CLIENT_MESH_FILES_GLTF_POSE_H_
#define LATVOX_CLIENT_MESH_FILES_GLTF_POSE_H_

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "client/json/json.h"
#include "client/mesh/affine.h"
#include "client/mesh_files/gltf_accessor.h"
#include "client/mesh_files/gltf_buffers.h"
#include "client/mesh_files/gltf_node.h"

namespace latvox::client {

// JOINTS_n and WEIGHTS_n: four joints of each vertex, by their indices in the skin, and their weights.
struct GltfInfluences {
  std::vector<double> joints, weights;
};

// Adds the displacements of the primitive's targets, times their weights, in double. Targets beyond the weights and
// weights beyond the targets have no effect.
// Errors: as ReadGltfNumbers; INVALID_ARGUMENT: a target has not one displacement for each position;
// RESOURCE_EXHAUSTED: all of them are more than kMostPlaced; also exceptions of the JSON library.
absl::Status ApplyTargets(const SortedJson& primitive, const std::vector<double>& weights, const SortedJson& root,
                          GltfBuffers& buffers, std::vector<Vec3d>& positions);

// Returns the transform of each joint of a skin: its place in the world after its inverse bind matrix.
// Errors: as ReadGltfNumbers and GltfWorldPlaces; INVALID_ARGUMENT: there are fewer matrices than joints.
absl::StatusOr<std::vector<Affine>> ReadGltfJoints(uint64_t skin, const SortedJson& root, GltfBuffers& buffers,
                                                   GltfWorldPlaces& places);

// Moves each position by the mean of its joints' transforms. Weights are divided by their sum; where it is 0, the
// vertex follows its first joint.
// Returns whether the first vertex is mirrored. Errors: INVALID_ARGUMENT naming a vertex with a joint that the skin
// lacks, or with a weight below 0.
absl::StatusOr<bool> ApplySkin(const std::vector<GltfInfluences>& sets, const std::vector<Affine>& joints,
                               std::vector<Vec3d>& positions);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_GLTF_POSE_H_
