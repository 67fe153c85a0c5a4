// Mesh files.
#ifndef LATVOX_CLIENT_MESH_MESH_FILE_H_
#define LATVOX_CLIENT_MESH_MESH_FILE_H_

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "client/mesh/mesh.h"
#include "client/mesh/mesh_format.h"

namespace latvox::client {

// The path that stands for standard input.
inline constexpr char kStandardInput[] = "-";

// How people call it: "standard input" for that.
std::string NameOfInput(const std::string& path);

// Whether the file is Draco by its extension.
bool IsDracoFile(const std::string& path);

// All bytes of the file. Errors, with the path: NOT_FOUND; INVALID_ARGUMENT (a directory, empty, not readable).
absl::StatusOr<std::string> ReadBytes(const std::string& path);

// The same of standard input, which is read to its end, for what is wanted there ("a mesh"). Errors: INVALID_ARGUMENT
// (a terminal, empty, not readable).
absl::StatusOr<std::string> ReadStandardInput(const char* what);

// Reads a file of one of the formats: all meshes of the file joined in world coordinates (node transforms applied),
// polygons triangulated, positions only. Binary float32 positions are taken over bit by bit.
// Errors, with the path: as ReadBytes; INVALID_ARGUMENT: another extension, damaged, an index out of range, a vertex
// that is not finite, no triangle at all; RESOURCE_EXHAUSTED: unpacks to too much.
absl::StatusOr<Mesh> ReadMeshFile(const std::string& path);

// The same of bytes that are known to be of the format, whatever the path's extension; the path is for errors alone.
// Files that a glTF refers to are looked for in the working directory.
absl::StatusOr<Mesh> ParseMeshFile(const std::string& path, absl::string_view bytes, MeshFormat format);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_MESH_FILE_H_
