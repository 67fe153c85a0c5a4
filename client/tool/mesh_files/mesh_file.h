// Mesh files.
#ifndef LATVOX_CLIENT_TOOL_MESH_FILES_MESH_FILE_H_
#define LATVOX_CLIENT_TOOL_MESH_FILES_MESH_FILE_H_

#include <string>

#include "absl/status/statusor.h"
#include "client/mesh/mesh.h"
#include "client/tool/mesh_files/mesh_format.h"

namespace latvox::client {

// Reads a file of one of the formats: all meshes of the file joined in world coordinates (node transforms applied),
// polygons triangulated, with what else of it Mesh has. Binary float32 positions are taken over bit by bit.
// Errors, with the path: as ReadBytes; INVALID_ARGUMENT: another extension, damaged, an index out of range, a vertex
// that is not finite, no triangle at all; RESOURCE_EXHAUSTED: unpacks to too much.
absl::StatusOr<Mesh> ReadMeshFile(const std::string& path);

// The same of bytes that are known to be of the format, whatever the path's extension; the path is for errors alone.
// Files that a glTF refers to are looked for in the working directory.
absl::StatusOr<Mesh> ParseMeshFile(const std::string& path, absl::string_view bytes, MeshFormat format);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_MESH_FILES_MESH_FILE_H_
