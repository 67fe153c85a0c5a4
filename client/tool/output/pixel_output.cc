#include "client/tool/output/pixel_output.h"

#include <charconv>
#include <filesystem>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "client/tool/output/pixel_picture.h"

namespace latvox::client {
namespace {

std::string ToCsv(const Pixelization& pixelization) {
  std::string csv = "i,j,x,y\n";
  for (const Vec2i& ij : pixelization.pixels) {
    const Vec2d world = pixelization.grid.ToWorld(ij);
    char text[120];
    char* end = text;
    for (const int32_t index : ij) {
      end = std::to_chars(end, text + sizeof(text), index).ptr;
      *end++ = ',';
    }
    for (size_t m = 0; m < 2; ++m) {
      // Equals printf's %.17g in the C locale, in any locale.
      end = std::to_chars(end, text + sizeof(text), world[m], std::chars_format::general, 17).ptr;
      *end++ = m == 1 ? '\n' : ',';
    }
    csv.append(text, end);
  }
  return csv;
}

}  // namespace

const std::vector<std::string>& PixelExtensions() {
  static const auto* const kExtensions = new std::vector<std::string>{".csv", ".png"};
  return *kExtensions;
}

absl::StatusOr<std::string> EncodePixels(const std::string& path, const Drawing& drawing,
                                         const Pixelization& pixelization) {
  const std::string extension = absl::AsciiStrToLower(std::filesystem::path(path).extension().string());
  if (extension == ".csv") return ToCsv(pixelization);
  if (extension == ".png") return DrawPixels(drawing, pixelization);
  return absl::InvalidArgumentError(absl::StrCat(path, ": extension \"", extension, "\" is not one of .csv .png"));
}

}  // namespace latvox::client
