// PNG files.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_PNG_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_PNG_H_

#include <string>

#include "absl/status/statusor.h"
#include "client/tool/output/image.h"

namespace latvox::client {

// Returns the bytes of a PNG file, without opacity if all of the picture is opaque. Errors: INTERNAL (libpng).
absl::StatusOr<std::string> EncodePng(const Image& picture);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_PNG_H_
