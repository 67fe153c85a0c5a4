// The triangles of a glTF primitive.
#ifndef LATVOX_CLIENT_MESH_FILES_GLTF_PRIMITIVE_H_
#define LATVOX_CLIENT_MESH_FILES_GLTF_PRIMITIVE_H_

#include <vector>

#include "absl/status/statusor.h"
#include "client/json/json.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/bad_elements.h"
#include "client/mesh_files/gltf_buffers.h"
#include "client/mesh_files/gltf_pose.h"

namespace latvox::client {

// How a node poses its mesh.
struct GltfPose {
  std::vector<double> weights;  // of the morph targets; the last one is not 0
  bool is_skinned = false;
  auto operator<=>(const GltfPose&) const = default;
};

struct GltfPrimitive {
  Mesh mesh;                               // its targets applied, its skin not
  std::vector<GltfInfluences> influences;  // none: without a skin
};

// Reads positions, triangles (also of strips and fans) and colors of vertices in sRGB: COLOR_0 times the material's
// factor, or that factor alone; none without both. Counts points and lines as skipped.
// A primitive without positions is empty, as the specification requires.
// Errors: as ReadGltfNumbers and ParseDraco; INVALID_ARGUMENT, with value and limit: an index beyond the vertices, a
// number of corners that is not a multiple of 3; also exceptions of the JSON library.
absl::StatusOr<GltfPrimitive> ReadGltfPrimitive(const SortedJson& primitive, const GltfPose& pose,
                                                const SortedJson& root, GltfBuffers& buffers, BadElements& bad);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_GLTF_PRIMITIVE_H_
