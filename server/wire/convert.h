// The request: protocol -> core. Maps each field of a message to a member of core, and judges nothing: what goes
// together is core/request's to say.
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
#include "server/wire/brick_batch.h"

namespace latvox {

// A request that needs only a mesh.
struct JobSpec {
  GridRequest grid;
  VoxelRequest request = {};
  BrickEncoding encoding = BrickEncoding::kMasks;
  uint64_t mesh_bytes = 0;  // declared length of the encoded mesh; 0: unknown
  std::optional<MeshDigest> mesh_digest = std::nullopt;
  RequestFields fields = {};
};

// Errors: INVALID_ARGUMENT for a number that no enumeration has, a required part that is missing, and all that
// MakeRequest and MakeGridRequest say; RESOURCE_EXHAUSTED for mesh_bytes over its limit; all with an ErrorCause.
absl::StatusOr<JobSpec> JobSpecFromProto(const v1::VoxelizeSpec& spec, const Limits& limits);

}  // namespace latvox

#endif  // LATVOX_SERVER_WIRE_CONVERT_H_
