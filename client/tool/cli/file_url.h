// Paths and file URLs of meshes.
#ifndef LATVOX_CLIENT_TOOL_CLI_FILE_URL_H_
#define LATVOX_CLIENT_TOOL_CLI_FILE_URL_H_

#include <string>

#include "absl/status/statusor.h"

namespace latvox::client {

// Returns the path that `text` means: a path, taken below `folder` unless it is absolute, or the path of a URL. A URL
// is one of RFC 8089: file:///PATH, file://localhost/PATH or file:/PATH, with %20 and the like decoded.
// Errors: INVALID_ARGUMENT (another scheme or host, a % without two hexadecimal digits, a NUL).
absl::StatusOr<std::string> PathOf(const std::string& text, const std::string& folder);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_FILE_URL_H_
