// The triangles of a glTF file, where their mesh has them.
#ifndef LATVOX_CLIENT_TOOL_MESH_FILES_GLTF_PRIMITIVE_H_
#define LATVOX_CLIENT_TOOL_MESH_FILES_GLTF_PRIMITIVE_H_

#include "absl/status/statusor.h"
#include "client/mesh/mesh.h"
#include "client/tool/json/json.h"
#include "client/tool/mesh_files/gltf_buffers.h"

namespace latvox::client {

// Positions, triangles (those of strips and fans, too), colors of vertices if there are any, and how many points and
// lines it has instead. Without positions it is empty, as the specification asks. Errors: as ReadGltfFloats and
// ParseDraco; INVALID_ARGUMENT, with value and limit: an index beyond the vertices, corners that are left over; also
// the JSON library's exceptions.
absl::StatusOr<Mesh> ReadGltfPrimitive(const SortedJson& primitive, const SortedJson& root, GltfBuffers& buffers);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_MESH_FILES_GLTF_PRIMITIVE_H_
