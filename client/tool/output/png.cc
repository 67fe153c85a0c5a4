#include "client/tool/output/png.h"

#include <png.h>

#include <cstdint>
#include <vector>

#include "absl/strings/str_cat.h"

namespace latvox::client {
namespace {

// Returns red, green and blue, or nothing if a pixel is not opaque.
std::vector<uint8_t> OpaqueColors(const std::vector<uint8_t>& rgba) {
  std::vector<uint8_t> rgb;
  rgb.reserve(rgba.size() / 4 * 3);
  for (size_t n = 0; n < rgba.size(); n += 4) {
    if (rgba[n + 3] != 255) return {};
    rgb.insert(rgb.end(), &rgba[n], &rgba[n] + 3);
  }
  return rgb;
}

}  // namespace

absl::StatusOr<std::string> EncodePng(const Image& picture) {
  const std::vector<uint8_t> rgb = OpaqueColors(picture.rgba());
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width());
  image.height = static_cast<png_uint_32>(picture.height());
  image.format = rgb.empty() ? PNG_FORMAT_RGBA : PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string png(size, '\0');
  const uint8_t* const pixels = rgb.empty() ? picture.rgba().data() : rgb.data();
  if (!png_image_write_to_memory(&image, png.data(), &size, 0, pixels, 0, nullptr)) {
    return absl::InternalError(absl::StrCat("the picture cannot be encoded (", image.message, ")"));
  }
  png.resize(size);
  return png;
}

}  // namespace latvox::client
