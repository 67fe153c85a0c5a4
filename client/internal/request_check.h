// What is wrong with a call whatever server it goes to. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_REQUEST_CHECK_H_
#define LATVOX_CLIENT_INTERNAL_REQUEST_CHECK_H_

#include <string_view>

#include "absl/status/status.h"
#include "latvox/plane_types.h"
#include "latvox/types.h"

namespace latvox::client {

// INVALID_ARGUMENT for no bytes: servers take them for a mesh that they are to have already.
absl::Status CheckMesh(std::string_view mesh_drc);

// INVALID_ARGUMENT for both a size and a resolution: the protocol would carry only the last one set.
absl::Status CheckRequest(const VoxelizeRequest& request);
absl::Status CheckRequest(const PixelizeRequest& request);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_REQUEST_CHECK_H_
