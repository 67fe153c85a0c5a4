// Mesh files.
#ifndef LATVOX_CLIENT_MESH_MESH_FILE_H_
#define LATVOX_CLIENT_MESH_MESH_FILE_H_

#include <string>

#include "absl/status/statusor.h"
#include "client/mesh/mesh.h"

namespace latvox::client {

// Whether the file is Draco by its extension, and so is sent as it is.
bool IsDracoFile(const std::string& path);

// Whether files of this extension may leave bytes of the mesh to other files: .glb, .gltf.
bool MayReferToFiles(const std::string& path);

// All bytes of the file. Errors, with the path: NOT_FOUND; INVALID_ARGUMENT (a directory, empty, not readable).
absl::StatusOr<std::string> ReadBytes(const std::string& path);

// Reads .obj, .ply, .stl, .glb or .gltf: all meshes of the file joined in world coordinates (node transforms applied),
// polygons triangulated, positions only. Binary float32 positions are taken over bit by bit.
// Errors, with the path: as ReadBytes; INVALID_ARGUMENT: another extension, damaged, an index out of range, a vertex
// that is not finite, no triangle at all.
absl::StatusOr<Mesh> ReadMeshFile(const std::string& path);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_MESH_FILE_H_
