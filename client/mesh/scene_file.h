// glTF, through assimp.
#ifndef LATVOX_CLIENT_MESH_SCENE_FILE_H_
#define LATVOX_CLIENT_MESH_SCENE_FILE_H_

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

// All triangles of the scene in world coordinates. Of glTF, assimp leaves out triangles with an index out of range
// without a word: see CheckGltf. Errors: INVALID_ARGUMENT naming what is wrong, without the path.
absl::StatusOr<Mesh> ReadSceneFile(const std::string& path);

// The same of a file's bytes; `extension`, without the dot, says what they are. Files that they refer to are looked for
// in the working directory.
absl::StatusOr<Mesh> ParseScene(absl::string_view bytes, const std::string& extension);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_SCENE_FILE_H_
