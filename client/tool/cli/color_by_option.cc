#include "client/tool/cli/color_by_option.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/mesh_names.h"
#include "client/tool/output/labels.h"

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
                               {ColorBy::kLinks, "the least share of the voxel's links, violet to yellow"},
                               {ColorBy::kLinkTriangles, "a color for the first triangle that its links meet"},
                               {ColorBy::kLinkCrossings, "a color for the most crossings of one of its links"},
                               {ColorBy::kFraction, "violet where nothing is inside, yellow where all is"},
                               {ColorBy::kLabelFractions, "the labels' colors, mixed by their fractions"},
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

std::vector<OptionRow> ColorByRows(ColorByWords& words) {
  return {{.names = "--color-by",
           .target = &words.source,
           .help = "Source of the voxels' colors, which the file must have",
           .words = WordsOf(AllNames()),
           .word_help = AllHelp(),
           .standard = "the first that the file has of color, material and part"},
          {.names = "--label",
           .target = &words.label,
           .help = "Color by the fraction of this label alone, a number or a name, from violet to yellow",
           .value = "LABEL"}};
}

void Check(const ColorByWords& words) {
  if (words.label.empty() || words.source.empty() || words.source == NameOf(ColorBy::kLabelFractions)) return;
  Refuse("--label: needs --color-by ", NameOf(ColorBy::kLabelFractions), ", not ", words.source);
}

absl::Status SelectLabel(const ColorByWords& words, const std::string& path, GridContent& content) {
  if (words.label.empty()) return absl::OkStatus();
  const auto refuse = [&](const auto&... why) { return absl::InvalidArgumentError(absl::StrCat(path, ": ", why...)); };
  const FieldValues* const fractions = FindField(content.fields, Field::kLabelFractions);
  if (fractions == nullptr) {
    return refuse("the voxels have no ", NameOf(Field::kLabelFractions), ", which --label requires");
  }
  const GridFileInfo& info = content.file.info;
  const auto labels = LabelsNamed({words.label}, "--label", FieldOfLabels(info), ReadCarriedNames(info));
  if (!labels.ok()) return refuse(labels.status().message());
  const auto has = [&](uint32_t label) {
    return std::ranges::find(fractions->labels, label) != fractions->labels.end();
  };
  if (std::ranges::none_of(*labels, has)) {
    return refuse("--label ", words.label, ": the voxels have fractions of ", absl::StrJoin(fractions->labels, ","));
  }
  FieldValues of_label = FractionOf(*fractions, *labels);
  std::erase_if(content.fields, [](const FieldValues& values) { return values.field == Field::kFraction; });
  content.fields.push_back(std::move(of_label));
  return absl::OkStatus();
}

ColorBy ColorByOf(const ColorByWords& words, bool distances, const GridContent& content) {
  if (!words.label.empty()) return ColorBy::kFraction;
  if (!words.source.empty()) return ValueNamed(AllNames(), words.source);
  VoxelTraits traits = TraitsOf(content);
  if (!distances) traits.distances.reset();
  return DefaultColorBy(traits);
}

absl::StatusOr<std::vector<uint32_t>> FileColors(const std::string& path, const GridContent& content, ColorBy by) {
  auto colors = ColorsOf(content.Batch(), TraitsOf(content), by);
  if (colors.ok()) return colors;
  return absl::InvalidArgumentError(absl::StrCat(path, ": ", colors.status().message(), ", which --color-by requires"));
}

std::string ColoredText(const ColorByWords& words, ColorBy by) {
  if (!words.label.empty()) return absl::StrCat(", colored by the fraction of ", words.label);
  return by == ColorBy::kNone ? "" : absl::StrCat(", colored by ", NameOf(by));
}

}  // namespace latvox::client
