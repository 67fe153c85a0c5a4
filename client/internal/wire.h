// Converts plain values to protocol messages and back. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_WIRE_H_
#define LATVOX_CLIENT_INTERNAL_WIRE_H_

#include <grpcpp/support/status.h>

#include <optional>

#include "absl/status/status.h"
#include "latvox/mesh_id.h"
#include "latvox/types.h"
#include "latvox/v1/voxelizer.pb.h"

namespace latvox::client {

// `resume_after`: the last tile that the client has.
v1::VoxelizeSpec ToProto(const VoxelizeRequest& request, const MeshId& mesh, const std::optional<Vec3i>& resume_after);

Accepted FromProto(const v1::Accepted& accepted);
Summary FromProto(const v1::Summary& summary);
Limits FromProto(const v1::GetLimitsResponse& limits);

// Returns code, message and the details of grpc-status-details-bin.
absl::Status FromGrpc(const grpc::Status& status);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_WIRE_H_
