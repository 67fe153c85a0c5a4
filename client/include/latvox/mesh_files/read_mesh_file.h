// Reads mesh files. Target latvox::mesh_files.
//
//   const absl::StatusOr<latvox::client::TriangleMesh> mesh = latvox::client::ReadMeshFile("bunny.obj");
//   if (!mesh.ok()) return mesh.status();
//   const absl::StatusOr<std::string> drc_bytes = latvox::client::EncodeMesh(*mesh);
#ifndef LATVOX_LATVOX_MESH_FILES_READ_MESH_FILE_H_
#define LATVOX_LATVOX_MESH_FILES_READ_MESH_FILE_H_

#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "latvox/export.h"
#include "latvox/mesh/triangle_mesh.h"
#include "latvox/mesh_files/up_axis.h"

namespace latvox::client {

// The formats of mesh files.
enum class MeshFormat {
  kDraco,    // .drc
  kObj,      // .obj
  kPly,      // .ply, text or binary
  kStl,      // .stl, text or binary
  kOff,      // .off, text or binary
  kGlb,      // .glb
  kGltf,     // .gltf, with the files that it names
  kThreeMf,  // .3mf
};

// All are optional.
struct ReadMeshOptions {
  // Default: by the extension, in any case; standard input: by its first bytes.
  std::optional<MeshFormat> format = std::nullopt;
  UpAxis up = UpAxis::kZ;  // the axis of the file that becomes z
  double scale = 1;        // multiplies positions, after the turn
  bool skip_bad = false;   // go on without broken elements; the warning BAD_ELEMENTS counts them
};

// Reads a file of triangles or polygons, or standard input for "-"; polygons are triangulated. All objects of the file
// become one mesh in world coordinates: each object is a part, and each material is numbered by its first use.
// Positions are those of the file, as doubles. Thread-safe. Errors, with the path and the place in the file:
// NOT_FOUND; INVALID_ARGUMENT (a directory, empty, an unknown extension, damaged, an index out of range, a position
// that is not finite, no triangle); FAILED_PRECONDITION (reading fails midway); RESOURCE_EXHAUSTED (memory, or it
// unpacks to too much).
LATVOX_EXPORT absl::StatusOr<TriangleMesh> ReadMeshFile(const std::string& path, const ReadMeshOptions& options = {});

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_MESH_FILES_READ_MESH_FILE_H_
