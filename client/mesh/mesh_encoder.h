// Encodes meshes as Draco streams, for the server.
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
  bool edgebreaker = false;   // otherwise sequential
};

// Encodes all triangles of the mesh, with positions and the fields, in the form of the protocol's Field.
// Positions are rounded to float32. That is all for 0 bits. Otherwise they are rounded to a grid of 2^bits - 1 steps
// along the longest side of their bounding box. Drops vertices that no triangle uses, and joins equal ones (bit by
// bit). Decodes the stream again, and checks that it has every triangle with its orientation. Preconditions: 0 <=
// quantization_bits <= kMaxQuantizationBits; CheckHas(attributes, mesh) is OK. Errors: INVALID_ARGUMENT (nothing to
// encode, an extent beyond float32), RESOURCE_EXHAUSTED (memory), INTERNAL.
absl::StatusOr<EncodedMesh> EncodeMesh(const Mesh& mesh, int quantization_bits,
                                       const std::vector<Field>& attributes = {});

// Returns bits that are fine enough to leave the voxels as they are, except where the surface passes very near to a
// decision. A step is at most 1/512 of a voxel, like the server's snapping. `voxels`: along the longest side of the
// bounding box, finite or not; 11 to 30.
int AutoQuantizationBits(double voxels);

// Returns the longest side of the bounding box of all triangles, world units.
double LongestSide(const Mesh& mesh);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_MESH_ENCODER_H_
