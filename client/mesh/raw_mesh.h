// Meshes as plain arrays, for the server.
#ifndef LATVOX_CLIENT_MESH_RAW_MESH_H_
#define LATVOX_CLIENT_MESH_RAW_MESH_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "client/mesh/mesh.h"
#include "latvox/mesh/encode_raw_mesh.h"
#include "latvox/types.h"
#include "latvox/warning.h"

namespace latvox::client {

// Returns whether float32 holds every position exactly.
bool FitsFloat32(const Mesh& mesh);

// Returns the arrays of the mesh, with float32 if that is exact and doubles otherwise. A vertex whose triangles carry
// several numbers becomes several vertices. Precondition: CheckHas(attributes, mesh) is OK.
RawMesh ToRaw(const Mesh& mesh, const std::vector<Field>& attributes);

// Returns a bound on the bytes of these arrays.
uint64_t MostRawBytes(const Mesh& mesh, const std::vector<Field>& attributes);

// Returns whether rounding positions to float32, as Draco does, could move them by more than half a step of the
// quantization, or at all if there is none (0 bits). Then only doubles are exact enough: the mesh is far from 0.
bool NeedsDoubles(const Mesh& mesh, int quantization_bits);

// Returns POSITIONS_ROUNDED if Draco's float32 would move positions further than such bits do; they are above 0.
std::optional<Warning> WarningOfRounding(const Mesh& mesh, int quantization_bits);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_RAW_MESH_H_
