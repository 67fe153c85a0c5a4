// Where a mesh lies that is named by a path or by a URL.
#ifndef LATVOX_CLIENT_TOOL_CLI_FILE_URL_H_
#define LATVOX_CLIENT_TOOL_CLI_FILE_URL_H_

#include <string>

#include "absl/status/statusor.h"

namespace latvox::client {

// The path that `text` means: itself, below `folder` unless it is absolute; or that of a URL as in RFC 8089,
// file:///PATH, file://localhost/PATH or file:/PATH, with %20 and its like decoded. Errors: INVALID_ARGUMENT (another
// scheme or host, a % without two hexadecimal digits, a NUL).
absl::StatusOr<std::string> PathOf(const std::string& text, const std::string& folder);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_FILE_URL_H_
