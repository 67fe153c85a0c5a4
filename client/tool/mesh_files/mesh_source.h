// Meshes as the tool is told to take them.
#ifndef LATVOX_CLIENT_TOOL_MESH_FILES_MESH_SOURCE_H_
#define LATVOX_CLIENT_TOOL_MESH_FILES_MESH_SOURCE_H_

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "client/mesh/mesh.h"
#include "client/mesh/up_axis.h"
#include "client/tool/mesh_files/mesh_format.h"
#include "latvox/types.h"

namespace latvox::client {

// Several meshes are one: what they enclose together is not known, their triangles are. Positions are turned, then
// multiplied by `scale` in double and rounded to float32 once. Their parts and materials are numbered in the order of
// the paths.
struct MeshSource {
  std::vector<std::string> paths;    // at least one; "-", once at most, is standard input
  std::optional<MeshFormat> format;  // of all of them; absent: by extension, of standard input by how it begins
  // Becomes z, by a quarter turn about another axis: (x, y, z) goes to (x, -z, y) for kY, which leaves x, and to
  // (-z, y, x) for kX, which leaves y. Exact.
  UpAxis up = UpAxis::kZ;
  double scale = 1;
  std::vector<Attribute> attributes = {};  // that each path's mesh must have, one Draco stream aside
};

// The paths for people.
std::string NameOf(const MeshSource& input);

// Whether the mesh is more than the bytes of one file: its files may refer to others.
bool MayReferToFiles(const MeshSource& input);

// One mesh, or the bytes of one Draco stream of which nothing is asked that would change them.
using MeshOrDraco = std::variant<Mesh, std::string>;

// Errors, with the path: as ReadMeshFile; INVALID_ARGUMENT: standard input is of no format that is known, a vertex is
// not finite once it is scaled, a mesh has no such attribute.
absl::StatusOr<MeshOrDraco> ReadMeshSource(const MeshSource& input);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_MESH_FILES_MESH_SOURCE_H_
