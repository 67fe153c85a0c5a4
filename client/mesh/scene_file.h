// STL and glTF, through assimp.
#ifndef LATVOX_CLIENT_MESH_SCENE_FILE_H_
#define LATVOX_CLIENT_MESH_SCENE_FILE_H_

#include <string>

#include "absl/status/statusor.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

// All triangles of the scene in world coordinates. Numbers in text files may come out one float32 beside the nearest.
// Of glTF, assimp leaves out triangles with an index out of range without a word.
// Errors: INVALID_ARGUMENT naming what is wrong, without the path.
absl::StatusOr<Mesh> ReadSceneFile(const std::string& path);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_SCENE_FILE_H_
