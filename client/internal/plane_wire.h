// Plain values of the plane to protocol messages and back. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_PLANE_WIRE_H_
#define LATVOX_CLIENT_INTERNAL_PLANE_WIRE_H_

#include "absl/status/statusor.h"
#include "latvox/plane_types.h"
#include "latvox/v1/voxelizer.pb.h"

namespace latvox::client {

v1::PixelizeRequest ToProto(const PixelizeRequest& request);

// Everything but the bytes. Errors: DATA_LOSS naming what breaks the protocol: a grid that is not usable, pixels out of
// order, another digest than theirs.
absl::StatusOr<Pixelization> FromProto(const v1::PixelizeResponse& response);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_PLANE_WIRE_H_
