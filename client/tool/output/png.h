// PNG files.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_PNG_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_PNG_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace latvox::client {

// Returns the bytes of a PNG file. Errors: INTERNAL (libpng).
//   rgb   3 * width * height bytes, rows from the top
absl::StatusOr<std::string> EncodePng(int width, int height, const std::vector<uint8_t>& rgb);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_PNG_H_
