// Accessors of glTF that are changed at some places: sparse ones.
#ifndef LATVOX_CLIENT_MESH_GLTF_SPARSE_H_
#define LATVOX_CLIENT_MESH_GLTF_SPARSE_H_

#include <nlohmann/json.hpp>
#include <string>

#include "absl/status/status.h"
#include "client/mesh/gltf_buffers.h"

namespace latvox::client {

// Holds every sparse accessor of the document against its views and buffers, used or not: assimp, which reads them,
// does not, and would read beyond them. Errors, with accessor, field, value and limit: INVALID_ARGUMENT: a field that
// is missing or no whole number, a view or buffer that is missing or too short, an index that is not below the count, a
// view that interleaves; RESOURCE_EXHAUSTED: more numbers than anyone has.
absl::Status CheckSparse(const nlohmann::json& root, GltfBuffers& buffers);

// All numbers of an accessor that is sparse, changed as it says. After CheckSparse.
std::string SparseBytes(const nlohmann::json& accessor, const nlohmann::json& root, GltfBuffers& buffers);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_GLTF_SPARSE_H_
