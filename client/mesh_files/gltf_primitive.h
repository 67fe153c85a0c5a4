// The triangles of a glTF primitive.
#ifndef LATVOX_CLIENT_MESH_FILES_GLTF_PRIMITIVE_H_
#define LATVOX_CLIENT_MESH_FILES_GLTF_PRIMITIVE_H_

#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "client/json/json.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/bad_elements.h"
#include "client/mesh_files/gltf_buffers.h"
#include "client/mesh_files/gltf_pose.h"
#include "client/mesh_files/gltf_texture.h"

namespace latvox::client {

// How a node poses its mesh.
struct GltfPose {
  std::vector<double> weights;  // of the morph targets; the last one is not 0
  bool is_skinned = false;
  auto operator<=>(const GltfPose&) const = default;
};

// The base color of a primitive, where that is more than the colors of its vertices.
struct GltfBaseColors {
  BaseColor color;
  std::vector<ImagePoint> places = {};    // of each vertex, in the image; none without an image
  std::vector<LinearRgba> vertices = {};  // COLOR_0 of each vertex; none: 1
};

struct GltfPrimitive {
  Mesh mesh;                               // its targets applied, its skin not
  std::vector<GltfInfluences> influences;  // none: without a skin
  std::optional<GltfBaseColors> base_colors = std::nullopt;
};

// Reads positions, triangles (also of strips and fans) and colors of vertices in sRGB: COLOR_0 times the material's
// factor, or that factor alone; none without both. Counts points and lines as skipped.
// Reads the base color as well, if `textures` is not null, and the color has an image or is not opaque.
// A primitive without positions is empty, as the specification requires.
// Errors: as ReadGltfNumbers and ParseDraco; INVALID_ARGUMENT, with value and limit: an index beyond the vertices, a
// number of corners that is not a multiple of 3; also exceptions of the JSON library.
absl::StatusOr<GltfPrimitive> ReadGltfPrimitive(const SortedJson& primitive, const GltfPose& pose,
                                                const SortedJson& root, GltfBuffers& buffers, BadElements& bad,
                                                GltfTextures* textures = nullptr);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_GLTF_PRIMITIVE_H_
