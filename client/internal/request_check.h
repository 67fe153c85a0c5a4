// Finds faults of a call that do not depend on the server. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_REQUEST_CHECK_H_
#define LATVOX_CLIENT_INTERNAL_REQUEST_CHECK_H_

#include <string_view>

#include "absl/status/status.h"
#include "latvox/plane_types.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns INVALID_ARGUMENT for an empty mesh, because servers take that for the name of a stored mesh.
absl::Status CheckMesh(std::string_view mesh_bytes);

// Returns INVALID_ARGUMENT for both a size and a resolution, because the protocol would carry only the last one set.
absl::Status CheckRequest(const VoxelizeRequest& request);
absl::Status CheckRequest(const PixelizeRequest& request);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_REQUEST_CHECK_H_
