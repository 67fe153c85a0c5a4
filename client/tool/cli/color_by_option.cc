#include "client/tool/cli/color_by_option.h"

#include "absl/strings/str_cat.h"
#include "client/tool/cli/common_options.h"

namespace latvox::client {
namespace {

struct Choice {
  ColorBy by;
  const char* help;
};
constexpr Choice kChoices[] = {{ColorBy::kColor, "the mesh's colors"},
                               {ColorBy::kMaterial, "a color for each material"},
                               {ColorBy::kPart, "a color for each part"},
                               {ColorBy::kDistance, "blue to red, or violet to yellow"},
                               {ColorBy::kTriangle, "a color for each triangle, twelve in all"},
                               {ColorBy::kPoint, "red, green and blue at the triangle's corners"},
                               {ColorBy::kNormal, "x, y and z as red, green and blue"},
                               {ColorBy::kFraction, "violet where nothing is inside, yellow where all is"},
                               {ColorBy::kNone, "one color"}};

Names<ColorBy> AllNames() {
  Names<ColorBy> names;
  for (const Choice& choice : kChoices) names.emplace_back(NameOf(choice.by), choice.by);
  return names;
}

std::vector<std::string> AllHelp() {
  std::vector<std::string> help;
  for (const Choice& choice : kChoices) help.emplace_back(choice.help);
  return help;
}

}  // namespace

OptionRow ColorByRow(std::string& word) {
  return {.names = "--color-by",
          .target = &word,
          .help = "Source of the voxels' colors, which the file must have",
          .words = WordsOf(AllNames()),
          .word_help = AllHelp(),
          .standard = "the first that the file has of color, material and part"};
}

ColorBy ColorByOf(const std::string& word, bool distances, const GridContent& content) {
  if (!word.empty()) return ValueNamed(AllNames(), word);
  VoxelTraits traits = TraitsOf(content);
  if (!distances) traits.distances.reset();
  return DefaultColorBy(traits);
}

absl::StatusOr<std::vector<uint32_t>> FileColors(const std::string& path, const GridContent& content, ColorBy by) {
  auto colors = ColorsOf(content.Batch(), TraitsOf(content), by);
  if (colors.ok()) return colors;
  return absl::InvalidArgumentError(absl::StrCat(path, ": ", colors.status().message(), ", which --color-by requires"));
}

std::string ColoredText(ColorBy by) { return by == ColorBy::kNone ? "" : absl::StrCat(", colored by ", NameOf(by)); }

}  // namespace latvox::client
