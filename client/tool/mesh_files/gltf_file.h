// glTF 2.0.
#ifndef LATVOX_CLIENT_TOOL_MESH_FILES_GLTF_FILE_H_
#define LATVOX_CLIENT_TOOL_MESH_FILES_GLTF_FILE_H_

#include <filesystem>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

// All triangles of the default scene, or else of the first, in world coordinates: the nodes' transforms are applied;
// skins, morph targets and animations are not, and weights of targets that are not 0 make a warning. Each node with
// triangles is a part; materials are numbered in the order in which they are first used, and what has none has the
// number after them; colors are those of vertices, or else the base color factor of the material, as they are (linear);
// a texture is not sampled, and then there is no color.
//   bytes    of a .glb or a .gltf
//   folder   of the files that it refers to; empty: the working directory
//   most     triangles, and vertices, of the scene, each counted as often as it is placed: a few bytes may place many
// Errors, without the path: as ParseGltfDocument, and INVALID_ARGUMENT or RESOURCE_EXHAUSTED naming node, mesh and
// primitive, accessor or buffer, what is wrong there, and the limit.
absl::StatusOr<Mesh> ParseGltf(absl::string_view bytes, const std::filesystem::path& folder, size_t most = kMostPlaced);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_MESH_FILES_GLTF_FILE_H_
