// The triangles of a glTF primitive.
#ifndef LATVOX_CLIENT_MESH_FILES_GLTF_PRIMITIVE_H_
#define LATVOX_CLIENT_MESH_FILES_GLTF_PRIMITIVE_H_

#include "absl/status/statusor.h"
#include "client/json/json.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/gltf_buffers.h"

namespace latvox::client {

// Reads positions, triangles (also of strips and fans) and colors of vertices, and counts points and lines as skipped.
// A primitive without positions is empty, as the specification requires.
// Errors: as ReadGltfFloats and ParseDraco; INVALID_ARGUMENT, with value and limit: an index beyond the vertices, a
// number of corners that is not a multiple of 3; also exceptions of the JSON library.
absl::StatusOr<Mesh> ReadGltfPrimitive(const SortedJson& primitive, const SortedJson& root, GltfBuffers& buffers);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_GLTF_PRIMITIVE_H_
