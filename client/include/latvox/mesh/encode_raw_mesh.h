// Lays out a mesh as plain arrays for Client::Voxelize, with every bit of its positions. Target latvox::mesh.
//
//   const absl::StatusOr<latvox::client::RawMesh> raw = latvox::client::EncodeRawMesh(mesh);
//   if (!raw.ok()) return raw.status();
//   request.raw_mesh = raw->layout;
//   const auto all = client.VoxelizeAll(request, raw->bytes);
//
// A program that has the arrays already can join their bytes itself: see RawMesh in the protocol.
#ifndef LATVOX_LATVOX_MESH_ENCODE_RAW_MESH_H_
#define LATVOX_LATVOX_MESH_ENCODE_RAW_MESH_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "latvox/export.h"
#include "latvox/mesh/triangle_mesh.h"
#include "latvox/types.h"

namespace latvox::client {

// A mesh as the bytes of its arrays.
struct RawMesh {
  RawMeshLayout layout;  // for VoxelizeRequest::raw_mesh
  std::string bytes;     // the arrays, one after the other, little-endian
};

// Lays out all triangles, degenerate and duplicate ones included. Positions are float32 if that holds all of them
// exactly, otherwise doubles. Thread-safe.
//   fields   of the mesh, which the arrays carry besides positions, each once
// Errors: INVALID_ARGUMENT naming field and element: no triangle, an index out of range, a position that is not finite,
// a list of another length, parts that descend, a field that is named twice or that the mesh lacks.
LATVOX_EXPORT absl::StatusOr<RawMesh> EncodeRawMesh(const TriangleMesh& mesh, const std::vector<Field>& fields = {});

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_MESH_ENCODE_RAW_MESH_H_
