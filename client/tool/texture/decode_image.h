// Images of textures.
#ifndef LATVOX_CLIENT_TOOL_TEXTURE_DECODE_IMAGE_H_
#define LATVOX_CLIENT_TOOL_TEXTURE_DECODE_IMAGE_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace latvox::client {

// Rows from the top; red, green and blue in sRGB and opacity for each pixel, not multiplied.
struct Pixels {
  uint32_t width = 0, height = 0;  // above 0
  std::vector<uint8_t> rgba = {};
};

// The most pixels of all images of a mesh together: 1 GiB.
inline constexpr uint64_t kMostPixels = uint64_t{1} << 28;

// Decodes PNG, JPEG or WebP, told by the first bytes. 16 bits are rounded to 8. Profiles and gammas are ignored, as
// glTF asks. Animations are errors.
//   most   the limit of pixels
// Errors: INVALID_ARGUMENT naming the reason: another format, damaged, cut short, CMYK; RESOURCE_EXHAUSTED with the
// limit.
absl::StatusOr<Pixels> DecodeImage(absl::string_view bytes, uint64_t most = kMostPixels);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_TEXTURE_DECODE_IMAGE_H_
