// What assimp says nothing of, or nothing useful, where a glTF file is wrong.
#ifndef LATVOX_CLIENT_MESH_GLTF_CHECK_H_
#define LATVOX_CLIENT_MESH_GLTF_CHECK_H_

#include <filesystem>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace latvox::client {

// Looks at the JSON, at sparse accessors (see CheckSparse), and at the vertex indices of every primitive of triangles:
// assimp would leave out those with an index beyond their vertices, and what is left over where their number is no
// multiple of 3. What else may be wrong, or cannot be read here, is left to assimp, which refuses it: accessors, views
// and buffers that are missing or too short.
//   bytes    of a .glb or a .gltf
//   folder   of the files that it refers to; empty: the working directory
// Errors: INVALID_ARGUMENT, without the path, naming the byte in the JSON, or mesh, primitive, index and limit, or
// as CheckSparse.
absl::Status CheckGltf(absl::string_view bytes, const std::filesystem::path& folder);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_GLTF_CHECK_H_
