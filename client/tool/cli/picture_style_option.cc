#include "client/tool/cli/picture_style_option.h"

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"

namespace latvox::client {
namespace {

constexpr char kTransparent[] = "transparent", kWhite[] = "white", kBlack[] = "black";
constexpr size_t kMostEntries = 12;  // in a legend

std::string CheckBackground(const std::string& text) {
  if (text == kTransparent || text == kWhite || text == kBlack || CheckColor(text).empty()) return "";
  return absl::StrCat("\"", text, "\" is not transparent, white, black or RRGGBB, six hexadecimal digits");
}

std::optional<Rgb8> ParseBackground(const std::string& text) {
  if (text == kTransparent) return std::nullopt;
  if (text == kWhite) return Rgb8{255, 255, 255};
  if (text == kBlack) return Rgb8{0, 0, 0};
  return ParseColor(text);
}

}  // namespace

std::string CheckColor(const std::string& text) {
  const absl::string_view digits = absl::StripPrefix(text, "#");
  const bool hex = digits.size() == 6 && digits.find_first_not_of("0123456789abcdefABCDEF") == absl::string_view::npos;
  return hex ? "" : absl::StrCat("\"", text, "\" is not RRGGBB, six hexadecimal digits");
}

Rgb8 ParseColor(const std::string& text) {
  uint32_t rgb = 0;
  static_cast<void>(absl::SimpleHexAtoi(absl::StripPrefix(text, "#"), &rgb));  // CheckColor has accepted it
  return {static_cast<uint8_t>(rgb >> 16), static_cast<uint8_t>(rgb >> 8), static_cast<uint8_t>(rgb)};
}

void AddPictureStyleOptions(CommandParser& command, const std::string& crop, PictureStyleWords& words) {
  command.Add({{.names = "--background",
                .target = &words.background,
                .help = "Color behind the voxels: transparent, white, black, or RRGGBB",
                .value = "COLOR",
                .checks = {{CheckBackground}},
                .standard = "f8f8f6"},
               {.names = "--legend",
                .target = &words.legend,
                .help = "Add a scale bar in units of the mesh, and the meaning of the colors, below the picture"},
               {.names = "--crop", .target = &words.crop, .help = crop}});
}

PictureStyle StyleOf(const PictureStyleWords& words, const GridContent& content, ColorBy by) {
  PictureStyle style;
  if (!words.background.empty()) style.background = ParseBackground(words.background);
  if (words.legend) style.legend = LegendOf(content, by, kMostEntries);
  return style;
}

}  // namespace latvox::client
