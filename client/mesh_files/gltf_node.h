// The places of glTF nodes.
#ifndef LATVOX_CLIENT_MESH_FILES_GLTF_NODE_H_
#define LATVOX_CLIENT_MESH_FILES_GLTF_NODE_H_

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "client/json/json.h"
#include "client/mesh/affine.h"
#include "client/mesh_files/gltf_buffers.h"

namespace latvox::client {

// Returns the transform of a node within its parent: its matrix, or its translation, rotation and scale.
// Errors: INVALID_ARGUMENT naming the field; also exceptions of the JSON library.
absl::StatusOr<Affine> GltfPlaceOf(const SortedJson& node);

// Returns the transforms of the node's instances within the node, by EXT_mesh_gpu_instancing; the identity alone if
// the node has no instances.
// Errors: as ReadGltfNumbers; INVALID_ARGUMENT: attributes of different counts or with other components, a rotation 0.
absl::StatusOr<std::vector<Affine>> ReadGltfInstances(const SortedJson& node, const SortedJson& root,
                                                      GltfBuffers& buffers);

// The places of nodes in the world, also of nodes outside the scene.
class GltfWorldPlaces {
 public:
  // `root` must outlive the object; `outer` is applied to all nodes last.
  GltfWorldPlaces(const SortedJson& root, const Affine& outer) : root_(root), outer_(outer) {}

  // Errors: as GltfPlaceOf; INVALID_ARGUMENT: the node has two parents, or is among its own ancestors.
  absl::StatusOr<Affine> Of(uint64_t node);

 private:
  absl::Status FindParents();

  const SortedJson& root_;
  const Affine outer_;
  std::vector<std::optional<uint64_t>> parents_;  // of each node; empty: not yet found
  std::map<uint64_t, Affine> places_;             // those found so far
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_GLTF_NODE_H_
