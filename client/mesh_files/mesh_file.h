// Mesh files.
#ifndef LATVOX_CLIENT_MESH_FILES_MESH_FILE_H_
#define LATVOX_CLIENT_MESH_FILES_MESH_FILE_H_

#include <string>

#include "absl/status/statusor.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/mesh_format.h"
#include "client/mesh_files/parse_options.h"

namespace latvox::client {

// Reads a file of any supported format. All meshes of the file are joined in world coordinates (node transforms
// applied), polygons are triangulated, and attributes are read into Mesh. Positions are those of the file.
// Errors, with the path: as ReadBytes; INVALID_ARGUMENT: another extension, damaged, an index out of range, a vertex
// that is not finite, no triangle at all; RESOURCE_EXHAUSTED: unpacks to too much.
absl::StatusOr<Mesh> ReadMesh(const std::string& path, const ParseOptions& options = {});

// Reads bytes of a known format. The path serves only for errors. Files that a glTF refers to are looked for in the
// working directory.
absl::StatusOr<Mesh> ParseMeshFile(const std::string& path, absl::string_view bytes, MeshFormat format,
                                   const ParseOptions& options = {});

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_MESH_FILE_H_
