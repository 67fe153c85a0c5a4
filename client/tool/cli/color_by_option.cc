#include "client/tool/cli/color_by_option.h"

#include "absl/strings/str_cat.h"
#include "client/tool/cli/common_options.h"

namespace latvox::client {
namespace {

Names<ColorBy> NamesOf(bool distances) {
  Names<ColorBy> names;
  for (const ColorBy by : {ColorBy::kColor, ColorBy::kMaterial, ColorBy::kPart}) names.emplace_back(NameOf(by), by);
  if (distances) names.emplace_back(NameOf(ColorBy::kDistance), ColorBy::kDistance);
  names.emplace_back(NameOf(ColorBy::kNone), ColorBy::kNone);
  return names;
}

std::vector<std::string> HelpOf(bool distances) {
  std::vector<std::string> help = {"the mesh's colors", "a color for each material", "a color for each part"};
  if (distances) help.emplace_back("blue to red");
  help.emplace_back("one color");
  return help;
}

}  // namespace

OptionRow ColorByRow(bool distances, std::string& word) {
  return {.names = "--color-by",
          .target = &word,
          .help = "Source of the voxels' colors, which the file must have",
          .words = WordsOf(NamesOf(distances)),
          .word_help = HelpOf(distances),
          .standard = "the first that the file has"};
}

ColorBy ColorByOf(const std::string& word, bool distances, const GridContent& content) {
  if (!word.empty()) return ValueNamed(NamesOf(distances), word);
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
