// Converts plain values of the plane to protocol messages and back. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_PLANE_WIRE_H_
#define LATVOX_CLIENT_INTERNAL_PLANE_WIRE_H_

#include "absl/status/statusor.h"
#include "latvox/plane_types.h"
#include "latvox/v1/voxelizer.pb.h"

namespace latvox::client {

v1::PixelizeRequest ToProto(const PixelizeRequest& request);

// Fills everything except the bytes. Errors: DATA_LOSS naming a breach of the protocol: an unusable grid, pixels out of
// order, a digest that is not theirs.
absl::StatusOr<Pixelization> FromProto(const v1::PixelizeResponse& response);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_PLANE_WIRE_H_
