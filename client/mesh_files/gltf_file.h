// glTF 2.0.
#ifndef LATVOX_CLIENT_MESH_FILES_GLTF_FILE_H_
#define LATVOX_CLIENT_MESH_FILES_GLTF_FILE_H_

#include <filesystem>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

// Returns all triangles of the default scene, or of the first scene, in world coordinates.
// - Transforms of nodes are applied; skins, morph targets and animations are not. Nonzero weights of morph targets
//   cause a warning.
// - Each node with triangles is a part.
// - Materials are numbered in order of first use. Triangles without a material get the number after the last one.
// - Colors are those of vertices, otherwise the base color factor of the material, as stored (linear). Textures are not
//   sampled, and a textured material has no color.
//   bytes    of a .glb or a .gltf
//   folder   of the files that it refers to; empty: the working directory
//   most     most triangles, and most vertices, of the scene, each counted as often as it is placed, because a few
//            bytes may place many
// Errors, without the path: as ParseGltfDocument; INVALID_ARGUMENT or RESOURCE_EXHAUSTED naming node, mesh and
// primitive, accessor or buffer, the fault, and the limit.
absl::StatusOr<Mesh> ParseGltf(absl::string_view bytes, const std::filesystem::path& folder, size_t most = kMostPlaced);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_GLTF_FILE_H_
