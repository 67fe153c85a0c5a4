// Converts requests of the protocol for core. It maps each field of a message to a member of core, and judges nothing:
// core/request decides which options go together.
#ifndef LATVOX_SERVER_WIRE_CONVERT_H_
#define LATVOX_SERVER_WIRE_CONVERT_H_

#include <cstdint>
#include <optional>

#include "absl/status/statusor.h"
#include "core/request/grid_request.h"
#include "core/request/request.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/base/errors.h"
#include "server/base/limits.h"
#include "server/decode/mesh_store.h"
#include "server/decode/raw_mesh.h"
#include "server/wire/brick_batch.h"

namespace latvox {

// A request that lacks only a mesh.
struct JobSpec {
  GridRequest grid;
  Placement placement = Placement::kPoints;  // never kBySet
  VoxelRequest request = {};
  BrickEncoding encoding = BrickEncoding::kMasks;
  uint64_t mesh_bytes = 0;  // declared length of the encoded mesh; 0: unknown
  std::optional<MeshDigest> mesh_digest = std::nullopt;
  RequestFields fields = {};
  std::optional<RawMeshLayout> raw_mesh = std::nullopt;  // absent: the mesh is Draco-encoded
};

// A mesh that is to be stored.
struct MeshSpec {
  MeshDigest digest = {};
  uint64_t bytes = 0;
  std::optional<RawMeshLayout> raw = std::nullopt;  // absent: the mesh is Draco-encoded

  bool operator==(const MeshSpec&) const = default;
};

// All have these errors, all with an ErrorCause: INVALID_ARGUMENT for a number outside its enumeration, for a missing
// part, and for every error of MakeRequest and MakeGridRequest; RESOURCE_EXHAUSTED for a mesh over its limits.
absl::StatusOr<RawMeshLayout> RawMeshFromProto(const v1::RawMesh& raw, const Limits& limits);
absl::StatusOr<MeshSpec> MeshSpecFromProto(const v1::PutMeshSpec& spec, const Limits& limits, uint64_t store_capacity);
absl::StatusOr<JobSpec> JobSpecFromProto(const v1::VoxelizeSpec& spec, const Limits& limits);

}  // namespace latvox

#endif  // LATVOX_SERVER_WIRE_CONVERT_H_
