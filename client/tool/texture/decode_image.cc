#include "client/tool/texture/decode_image.h"

#include <png.h>
#include <turbojpeg.h>
#include <webp/decode.h>

#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <string>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"

namespace latvox::client {
namespace {

template <class... Parts>
absl::Status Bad(const Parts&... parts) {
  return absl::InvalidArgumentError(absl::StrCat(parts...));
}

// Takes the memory for an image, if it is within the limit.
absl::StatusOr<Pixels> NewPixels(uint64_t width, uint64_t height, uint64_t most) {
  if (width == 0 || height == 0) return Bad("is damaged (", width, " x ", height, " pixels)");
  if (width > UINT32_MAX || height > most / width) {
    return absl::ResourceExhaustedError(
        absl::StrCat("has ", width, " x ", height, " pixels, and all images may together have ", most, " more"));
  }
  return Pixels{static_cast<uint32_t>(width), static_cast<uint32_t>(height),
                std::vector<uint8_t>(static_cast<size_t>(4 * width * height))};
}

// The state of a PNG reader. libpng leaves its functions with longjmp, so nothing between may need a destructor.
struct PngReader {
  absl::string_view rest;
  char error[200] = "";
};

void ReadPngBytes(png_structp png, png_bytep to, size_t size) {
  auto& reader = *static_cast<PngReader*>(png_get_io_ptr(png));
  if (size > reader.rest.size()) png_error(png, "is cut short");
  std::memcpy(to, reader.rest.data(), size);
  reader.rest.remove_prefix(size);
}

[[noreturn]] void StopPng(png_structp png, png_const_charp message) {
  auto& reader = *static_cast<PngReader*>(png_get_error_ptr(png));
  std::strncpy(reader.error, message, sizeof(reader.error) - 1);
  png_longjmp(png, 1);
}

void IgnoreWarning(png_structp, png_const_charp) {}

// Reads the header, and asks for rows of 8-bit red, green, blue, opacity. Returns false after an error.
bool ReadPngHeader(png_structp png, png_infop info) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_read_info(png, info);
  png_set_expand(png);
  png_set_scale_16(png);
  png_set_gray_to_rgb(png);
  png_set_add_alpha(png, 0xFF, PNG_FILLER_AFTER);
  png_set_interlace_handling(png);
  png_read_update_info(png, info);
  return true;
}

bool ReadPngRows(png_structp png, png_bytepp rows) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  png_read_image(png, rows);
  png_read_end(png, nullptr);
  return true;
}

absl::StatusOr<Pixels> DecodePng(absl::string_view bytes, uint64_t most) {
  PngReader reader{bytes};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, StopPng, IgnoreWarning);
  png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
  const absl::Cleanup end = [&] { png_destroy_read_struct(&png, &info, nullptr); };
  if (info == nullptr) return absl::ResourceExhaustedError("there is no memory to decode PNG");
  png_set_read_fn(png, &reader, ReadPngBytes);
  if (!ReadPngHeader(png, info)) return Bad("is damaged (PNG: ", reader.error, ")");
  auto pixels = NewPixels(png_get_image_width(png, info), png_get_image_height(png, info), most);
  if (!pixels.ok()) return pixels;
  const size_t row_bytes = size_t{4} * pixels->width;
  if (png_get_rowbytes(png, info) != row_bytes) return Bad("is a kind of PNG that is not read");
  std::vector<png_bytep> rows(pixels->height);
  for (size_t y = 0; y < rows.size(); ++y) rows[y] = &pixels->rgba[y * row_bytes];
  if (!ReadPngRows(png, rows.data())) return Bad("is damaged (PNG: ", reader.error, ")");
  return pixels;
}

absl::StatusOr<Pixels> DecodeJpeg(absl::string_view bytes, uint64_t most) {
  const tjhandle jpeg = tjInitDecompress();
  if (jpeg == nullptr) return absl::ResourceExhaustedError("there is no memory to decode JPEG");
  const absl::Cleanup end = [jpeg] { tjDestroy(jpeg); };
  const auto damaged = [jpeg] { return Bad("is damaged (", tjGetErrorStr2(jpeg), ")"); };
  const auto* const data = reinterpret_cast<const unsigned char*>(bytes.data());
  int width = 0, height = 0, subsampling = 0, space = 0;
  if (tjDecompressHeader3(jpeg, data, bytes.size(), &width, &height, &subsampling, &space) != 0) return damaged();
  if (space == TJCS_CMYK || space == TJCS_YCCK) return Bad("is a JPEG in CMYK, which is not read");
  auto pixels = NewPixels(static_cast<uint64_t>(width), static_cast<uint64_t>(height), most);
  if (!pixels.ok()) return pixels;
  constexpr int kFlags = TJFLAG_STOPONWARNING | TJFLAG_LIMITSCANS | TJFLAG_ACCURATEDCT;  // few bytes may be many scans
  if (tjDecompress2(jpeg, data, bytes.size(), pixels->rgba.data(), width, 0, height, TJPF_RGBA, kFlags) != 0) {
    return damaged();
  }
  return pixels;
}

absl::StatusOr<Pixels> DecodeWebp(absl::string_view bytes, uint64_t most) {
  const auto* const data = reinterpret_cast<const uint8_t*>(bytes.data());
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(data, bytes.size(), &features) != VP8_STATUS_OK) return Bad("is damaged (WebP: its header)");
  if (features.has_animation != 0) return Bad("is an animated WebP, which is not read");
  auto pixels = NewPixels(static_cast<uint64_t>(features.width), static_cast<uint64_t>(features.height), most);
  if (!pixels.ok()) return pixels;
  const int stride = 4 * features.width;
  if (WebPDecodeRGBAInto(data, bytes.size(), pixels->rgba.data(), pixels->rgba.size(), stride) == nullptr) {
    return Bad("is damaged or cut short (WebP)");
  }
  return pixels;
}

}  // namespace

absl::StatusOr<Pixels> DecodeImage(absl::string_view bytes, uint64_t most) {
  if (absl::StartsWith(bytes, "\x89PNG\r\n\x1a\n")) return DecodePng(bytes, most);
  if (absl::StartsWith(bytes, "\xff\xd8\xff")) return DecodeJpeg(bytes, most);
  if (absl::StartsWith(bytes, "RIFF") && bytes.size() > 12 && bytes.substr(8, 4) == "WEBP") {
    return DecodeWebp(bytes, most);
  }
  return Bad("is not PNG, JPEG or WebP");
}

}  // namespace latvox::client
