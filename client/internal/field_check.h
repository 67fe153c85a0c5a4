// Checks the values of fields that a server sends. Internal to the SDK.
#ifndef LATVOX_CLIENT_INTERNAL_FIELD_CHECK_H_
#define LATVOX_CLIENT_INTERNAL_FIELD_CHECK_H_

#include "absl/status/status.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns the width of a band in the mesh's units.
double BandWidth(const Band& band, const GridTransform& grid);

// Checks that all values are possible for the request and the accepted mesh. Errors: DATA_LOSS that names a value.
absl::Status CheckFieldValues(const FieldValues& field, const VoxelizeRequest& request, const Accepted& accepted);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_FIELD_CHECK_H_
