// Errors in a file, as statuses.
#ifndef LATVOX_CLIENT_MESH_FILES_BAD_H_
#define LATVOX_CLIENT_MESH_FILES_BAD_H_

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace latvox::client {

// Returns INVALID_ARGUMENT with the text of the parts.
template <class... Parts>
absl::Status Bad(const Parts&... parts) {
  return absl::InvalidArgumentError(absl::StrCat(parts...));
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_BAD_H_
