// Protocol <-> core: the one place where a field of a message meets a member of core.
#ifndef LATVOX_SERVER_WIRE_CONVERT_H_
#define LATVOX_SERVER_WIRE_CONVERT_H_

#include <cstdint>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "core/voxelizer/voxelizer.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/base/errors.h"
#include "server/base/limits.h"
#include "server/base/mesh_attributes.h"
#include "server/decode/mesh_store.h"
#include "server/wire/brick_batch.h"

namespace latvox {

// A specification that needs only a mesh.
struct JobSpec {
  Lattice lattice;
  Density density;
  std::optional<Vec3d> origin;
  VoxelizeOptions options;
  bool verify = false;
  BrickEncoding encoding = BrickEncoding::kMasks;
  uint64_t mesh_bytes = 0;  // declared length of the encoded mesh; 0: unknown
  std::optional<MeshDigest> mesh_digest = std::nullopt;
  MeshAttributes attributes = {};  // that the mesh must have; options.attributes of them
  RequestFields fields = {};
};

// Checks everything that can be checked without the mesh. Errors: INVALID_ARGUMENT, and RESOURCE_EXHAUSTED for
// mesh_bytes over its limit; all with an ErrorCause.
absl::StatusOr<JobSpec> JobSpecFromProto(const v1::VoxelizeSpec& spec, const Limits& limits);

// What core does not know of a mesh.
struct MeshSource {
  Bounds bounds;
  uint32_t quantization_bits = 0;
};

v1::Accepted AcceptedToProto(const std::string& request_id, const Grid& grid, const JobFacts& facts,
                             const MeshSource& source);

// `verdict` is set if the result was verified.
v1::Certificate CertificateToProto(const JobSpec& spec, const JobFacts& facts, const MeshSource& source,
                                   const JobTotals& totals, const std::optional<Verdict>& verdict);

v1::GetLimitsResponse LimitsToProto(const Limits& limits);

}  // namespace latvox

#endif  // LATVOX_SERVER_WIRE_CONVERT_H_
