// Meshes to Draco streams, the form in which the server takes them.
#ifndef LATVOX_CLIENT_MESH_MESH_ENCODER_H_
#define LATVOX_CLIENT_MESH_MESH_ENCODER_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/mesh/mesh.h"
#include "latvox/types.h"

namespace latvox::client {

inline constexpr int kMaxQuantizationBits = 30;  // Draco's limit

struct EncodedMesh {
  std::string drc;
  int quantization_bits = 0;  // 0: positions are exact
  bool edgebreaker = false;   // else sequential
};

// Encodes all triangles of the mesh, with positions and the attributes, as Attribute of the protocol has them.
// Positions are exact for 0 bits; else they are rounded to a grid of 2^bits - 1 steps along the longest side of their
// bounding box. Vertices that no triangle uses are left out, and equal ones (bit by bit) joined. The stream was decoded
// again and holds every triangle with the sense of rotation it had. Preconditions: 0 <= quantization_bits <=
// kMaxQuantizationBits; CheckHas(attributes, mesh) is OK. Errors: INVALID_ARGUMENT (nothing to encode, an extent beyond
// float32), RESOURCE_EXHAUSTED (memory), INTERNAL.
absl::StatusOr<EncodedMesh> EncodeMesh(const Mesh& mesh, int quantization_bits,
                                       const std::vector<Attribute>& attributes = {});

// Bits fine enough to leave the voxels as they are but where the surface passes very near to a decision: a step is at
// most 1/512 of a voxel, the same as the server's snapping. `voxels` along the longest side of the bounding box, finite
// or not; 11 to 30.
int AutoQuantizationBits(double voxels);

// Longest side of the bounding box of all triangles, world units.
double LongestSide(const Mesh& mesh);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_MESH_ENCODER_H_
