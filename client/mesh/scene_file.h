// glTF, through assimp.
#ifndef LATVOX_CLIENT_MESH_SCENE_FILE_H_
#define LATVOX_CLIENT_MESH_SCENE_FILE_H_

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

// All triangles of the scene in world coordinates. Each node with a mesh is a part; materials are numbered in the order
// in which they are first used, and what has none has the number after them; colors are those of vertices, or else the
// base color factor of the material, as they are (linear); a texture is not sampled, and then there is no color. Of
// glTF, assimp leaves out triangles with an index out of range without a word: see CheckGltf. Errors: INVALID_ARGUMENT
// naming what is wrong, without the path.
absl::StatusOr<Mesh> ReadSceneFile(const std::string& path);

// The same of a file's bytes; `extension`, without the dot, says what they are. Files that they refer to are looked for
// in the working directory.
absl::StatusOr<Mesh> ParseScene(absl::string_view bytes, const std::string& extension);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_SCENE_FILE_H_
