// Converts core's answers to the protocol.
#ifndef LATVOX_SERVER_WIRE_ANSWERS_H_
#define LATVOX_SERVER_WIRE_ANSWERS_H_

#include <cstdint>
#include <optional>
#include <string>

#include "core/lattice/grid.h"
#include "core/mesh/mesh.h"
#include "core/verify/verify.h"
#include "core/voxelizer/voxelizer.h"
#include "deploy/manual/build_facts.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/base/limits.h"
#include "server/wire/convert.h"

namespace latvox {

// The facts about a mesh that core does not know.
struct MeshSource {
  Bounds bounds;
  uint32_t quantization_bits = 0;
};

v1::Accepted AcceptedToProto(const std::string& request_id, const VoxelRequest& request, const Grid& grid,
                             Placement placement, const JobFacts& facts, const MeshSource& source);

// `verdict` is set if the result was verified.
v1::Certificate CertificateToProto(const JobSpec& spec, const JobFacts& facts, const MeshSource& source,
                                   const JobTotals& totals, const std::optional<Verdict>& verdict);

v1::GetLimitsResponse LimitsToProto(const Limits& limits, const BuildFacts& build);

}  // namespace latvox

#endif  // LATVOX_SERVER_WIRE_ANSWERS_H_
