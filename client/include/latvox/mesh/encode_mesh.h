// Encodes a mesh to the bytes for Client::Voxelize, without Draco's headers. Target latvox::mesh.
//
//   const std::vector<std::array<float, 3>> positions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
//   const std::vector<std::array<uint32_t, 3>> triangles = {{0, 1, 2}};
//   const absl::StatusOr<std::string> drc_bytes = latvox::client::EncodeMesh(positions, triangles);
#ifndef LATVOX_LATVOX_MESH_ENCODE_MESH_H_
#define LATVOX_LATVOX_MESH_ENCODE_MESH_H_

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "latvox/export.h"
#include "latvox/mesh/triangle_mesh.h"
#include "latvox/types.h"

namespace latvox::client {

// Encodes all triangles, degenerate and duplicate ones included, as a Draco stream. Each triangle indexes three
// positions.
//   quantization_bits   0: positions are exact. Up to 30: they are rounded to a grid of 2^bits - 1 steps along the
//                       longest side of their bounding box, and the stream is smaller
// Decodes the stream again, and checks that it has every triangle with its orientation. Thread-safe. Errors:
// INVALID_ARGUMENT naming field and element: no triangle, an index out of range, a position that is not finite, bits
// beyond 0 to 30; RESOURCE_EXHAUSTED (memory), INTERNAL.
LATVOX_EXPORT absl::StatusOr<std::string> EncodeMesh(std::span<const std::array<float, 3>> positions,
                                                     std::span<const std::array<uint32_t, 3>> triangles,
                                                     int quantization_bits = 0);

// All are optional.
struct EncodeOptions {
  std::vector<Field> fields = {};  // of the mesh, which the stream carries besides positions, each once
  int quantization_bits = 0;       // 0 to 30, as for arrays
};

// Encodes a mesh with fields in the same way, for a request with them among VoxelizeRequest::fields. Rounds positions
// to float32, because Draco streams of this service have no others; EncodeRawMesh keeps doubles. Errors: as above, and
// INVALID_ARGUMENT for a position beyond float32, a list of another length, parts that descend, a field that is named
// twice or that the mesh lacks.
LATVOX_EXPORT absl::StatusOr<std::string> EncodeMesh(const TriangleMesh& mesh, const EncodeOptions& options = {});

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_MESH_ENCODE_MESH_H_
