// The mesh of a command: its files and their transform.
#ifndef LATVOX_CLIENT_MESH_FILES_MESH_SOURCE_H_
#define LATVOX_CLIENT_MESH_FILES_MESH_SOURCE_H_

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "client/mesh/mesh.h"
#include "client/mesh_files/mesh_format.h"
#include "latvox/mesh_files/up_axis.h"
#include "latvox/types.h"

namespace latvox::client {

// Several meshes form one, as the union of their triangles. Positions are turned, then multiplied by `scale`, in double
// as well. Parts and materials are numbered in the order of the paths. If there are several files, the parts of a file
// without names of parts are named like the file.
struct MeshSource {
  std::vector<std::string> paths;    // at least one; "-" is standard input, at most once
  std::optional<MeshFormat> format;  // of all files; absent: by extension, or by the first bytes of standard input
  UpAxis up = UpAxis::kZ;            // the axis that becomes z
  double scale = 1;
  bool skip_bad = false;               // go on without broken elements, with the warning BAD_ELEMENTS
  std::vector<Field> attributes = {};  // required of each mesh, except a single Draco stream
  bool base_colors = false;            // read Mesh::base_colors
};

// Returns the paths in a form for people.
std::string NameOf(const MeshSource& input);

// Returns whether the mesh may be more than the bytes of one file, because its files may refer to others.
bool MayReferToFiles(const MeshSource& input);

// One mesh, or the bytes of one Draco stream that is sent unchanged.
using MeshOrDraco = std::variant<Mesh, std::string>;

// Errors, with the path: as ReadMesh; INVALID_ARGUMENT: standard input has no known format, a vertex is not finite
// after scaling, a mesh lacks a required attribute.
absl::StatusOr<MeshOrDraco> ReadMeshSource(const MeshSource& input);

// Turns and scales a mesh that comes in place of files. Errors: INVALID_ARGUMENT: a vertex is not finite after scaling;
// the mesh lacks a required attribute.
absl::Status PlaceMesh(const MeshSource& input, Mesh& mesh);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_MESH_SOURCE_H_
