// What is wrong with a file, as a status.
#ifndef LATVOX_CLIENT_TOOL_MESH_FILES_BAD_H_
#define LATVOX_CLIENT_TOOL_MESH_FILES_BAD_H_

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace latvox::client {

// INVALID_ARGUMENT with the parts' text.
template <class... Parts>
absl::Status Bad(const Parts&... parts) {
  return absl::InvalidArgumentError(absl::StrCat(parts...));
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_MESH_FILES_BAD_H_
