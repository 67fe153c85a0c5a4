#include "client/tool/cli/set_options.h"

#include <algorithm>
#include <optional>
#include <string>
#include <variant>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "client/tool/cli/common_options.h"
#include "client/tool/cli/set_labels.h"
#include "client/tool/output/output.h"

namespace latvox::client {
namespace {

constexpr uint32_t kLeastPoints = 2, kMostPoints = 16;  // of fractions, along each axis of a cell

const Names<Field>& FieldNames() {
  static const auto* const kNames = [] {
    auto* const names = new Names<Field>;
    for (const FieldFacts& row : kFields) names->emplace_back(row.name, row.field);
    return names;
  }();
  return *kNames;
}

// Removes the number of points from fraction:N or label_fractions:N. Returns false if it has none; other words have
// none.
bool ConsumePoints(absl::string_view& word, uint32_t& points) {
  const absl::string_view name = word.substr(0, word.find(':'));
  if (name != NameOf(Field::kFraction) && name != NameOf(Field::kLabelFractions)) return true;
  const absl::string_view number = absl::StripPrefix(word.substr(name.size()), ":");
  word = name;
  return ParseNumber(number, points);
}

WrongWord CheckFields(const std::string& text) {
  std::vector<absl::string_view> seen;
  std::optional<uint32_t> before;
  for (absl::string_view word : absl::StrSplit(text, ',')) {
    const size_t length = word.size();
    uint32_t points = 0;
    if (!ConsumePoints(word, points)) {
      return absl::StrCat(word, " needs a number of points along each axis, such as ", word, ":8");
    }
    const bool has_points = word.size() < length;
    if (has_points && (points < kLeastPoints || points > kMostPoints)) {
      const std::string range = absl::StrCat(kLeastPoints, " to ", kMostPoints);
      return {absl::StrCat("\"", word, ":", points, "\": ", points, " is not a whole number from ", range),
              absl::StrCat(points), range};
    }
    if (std::find(seen.begin(), seen.end(), word) != seen.end()) return absl::StrCat("\"", word, "\" is given twice");
    if (has_points && before && points != *before) {
      return absl::StrCat("fraction and label_fractions need the same number of points, not ", *before, " and ",
                          points);
    }
    if (has_points) before = points;
    const auto has_name = [word](const auto& name) { return name.first == word; };
    if (std::none_of(FieldNames().begin(), FieldNames().end(), has_name)) {
      const std::string known = absl::StrJoin(WordsOf(FieldNames()), ", ");
      return {absl::StrCat("\"", word, "\" is not one of ", known), std::string(word), known};
    }
    seen.push_back(word);
  }
  return "";
}

std::string CheckLabels(const std::string& text) {
  for (const absl::string_view word : absl::StrSplit(text, ',')) {
    if (word.empty()) return absl::StrCat("\"", text, "\" has an empty label");
  }
  return "";
}

std::optional<Band> ParseBand(absl::string_view text) {
  Band band;
  band.in_voxels = absl::ConsumeSuffix(&text, "v");
  if (!ParseNumber(text, band.width) || !(band.width > 0)) return std::nullopt;
  return band;
}

WrongWord CheckBand(const std::string& text) {
  if (ParseBand(text)) return "";
  return {absl::StrCat("\"", text, "\" is not a finite number above 0, with or without v for voxel sizes"), text, "0"};
}

const Names<Field>& LabelNames() {
  static const auto* const kNames = new Names<Field>{{"part", Field::kPart}, {"material", Field::kMaterial}};
  return *kNames;
}

// The labels of a set. A priority needs some: those among the fields.
std::optional<Field> LabelsOf(const VoxelizeWords& words) {
  if (!words.labels.empty()) return ValueNamed(LabelNames(), words.labels);
  if (words.priority.empty()) return std::nullopt;
  std::optional<Field> labels;
  for (const absl::string_view word : absl::StrSplit(words.fields, ',')) {
    for (const auto& [name, field] : LabelNames()) {
      if (word != name) continue;
      if (labels) Refuse("--priority: needs --labels, because --fields has both part and material");
      labels = field;
    }
  }
  if (!labels) Refuse("--priority: needs --labels part or material");
  return labels;
}

// The labels that an option lists, if all are numbers. Otherwise the mesh's file must be read first.
std::vector<uint32_t> NumbersOf(const std::vector<std::string>& labels) {
  std::vector<uint32_t> numbers;
  for (const std::string& label : labels) {
    uint32_t number = 0;
    if (!ParseNumber(label, number)) return {};
    numbers.push_back(number);
  }
  return numbers;
}

std::vector<std::string> LabelWords(const std::string& text) {
  if (text.empty()) return {};
  return absl::StrSplit(text, ',');
}

// Without a word, the rule is that of the mesh's format. A mesh without an extension has its format only by that word.
InteriorRule RuleOf(const VoxelizeWords& words) {
  if (!words.rule.empty()) return ValueNamed(RuleNames(), words.rule);
  const auto is_3mf = [&words](const std::string& path) {
    return words.input_format.empty() ? HasExtension(path, {".3mf"}) : words.input_format == "3mf";
  };
  const std::vector<std::string>& paths = words.options.mesh.paths;
  const bool all = !paths.empty() && std::all_of(paths.begin(), paths.end(), is_3mf);
  return all ? InteriorRule::kPositive : InteriorRule::kAuto;
}

// The rule for other sets than solids, which have their own.
void InterpretRule(const VoxelizeWords& words, VoxelizeRequest& request) {
  if (NeedsInteriorRule(request)) {
    request.interior_rule = RuleOf(words);
  } else if (!words.rule.empty() && !std::holds_alternative<Solid>(request.set)) {
    Refuse(
        "--rule: needs --set solid, supercover-solid or interior, or --signed, a fraction or one --side of links, "
        "not ",
        NameOf(request.set), " alone");
  }
}

void CheckOrder(const VoxelizeOptions& options) {
  if (options.upload != UploadForm::kDraco) return;
  for (const Field field : options.request.fields) {
    if (FactsOf(field).needs_order()) {
      Refuse("--fields: ", NameOf(field), " needs --upload raw; Draco changes the order of triangles");
    }
  }
}

WrongWord CheckOpacity(const std::string& text) {
  double number = 0;
  if (ParseNumber(text, number) && number >= 0 && number <= 1) return "";
  return {absl::StrCat("\"", text, "\" is not a number from 0 to 1"), text, "0 to 1"};
}

// The tool needs the mesh's base colors, and images, only for these.
void InterpretBaseColors(const VoxelizeWords& words, VoxelizeOptions& options) {
  options.mesh.base_colors = CarriesField(options.request.fields, Field::kColor) || !words.alpha_cutoff.empty();
  if (words.alpha_cutoff.empty()) return;
  if (options.request.verify) {
    Refuse("--alpha-cutoff: cannot be combined with --verify, because it leaves holes in a set without tunnels");
  }
  ParseNumber(words.alpha_cutoff, options.alpha_cutoff.emplace());
}

WrongWord CheckWidth(const std::string& text) {
  double number = 0;
  if (ParseNumber(text, number) && number >= 0) return "";
  return {absl::StrCat("\"", text, "\" is not a finite number, at least 0"), text, "0"};
}

std::vector<OptionRow> PointRows(VoxelizeWords& words) {
  return {
      {.names = "--set",
       .target = &words.set,
       .help = "Set of lattice points",
       .words = WordsOf(SetNames()),
       .word_help = {"the fewest voxels of the mesh that let no path through", "all voxels whose cell meets the mesh",
                     "surface and interior of a closed mesh", "supercover and interior",
                     "only points whose center is inside", "all points near the mesh, see --band",
                     "both ends of every link between neighbors that the mesh crosses",
                     "surface and all points that no walk from outside reaches; the mesh may be open",
                     "the same without the surface", "all points that a walk from --seed reaches"},
       .standard = "surface, unless --band is given"},
      {.names = "--rule",
       .target = &words.rule,
       .help = "Rule for the inside: of a solid, of --signed, of a fraction, of one --side; winding and positive unite "
               "bodies that overlap",
       .words = WordsOf(RuleNames()),
       .word_help = {"winding if the triangles are oriented alike, else parity",
                     "inside after an odd number of crossings", "inside where the mesh winds around",
                     "inside where the mesh winds around, but not inside out"},
       .standard = "auto; for 3MF, positive, as that format asks"},
      {.names = "--force-open",
       .target = &words.force_open,
       .help = "Fill a mesh that is not closed, except along lattice lines in k that end unbalanced"},
      {.names = "--seed",
       .target = &words.seed,
       .help = "World position where the walk of a region starts, at the nearest lattice point",
       .value = "X,Y,Z",
       .checks = {{CheckNumbers<double, 3>}}},
      {.names = "--close",
       .target = &words.close,
       .help = "Close holes of enclosed sets and regions up to a width of G, world units, less the longest step "
               "between neighbors; 0 closes none",
       .value = "G",
       .checks = {{CheckWidth}}},
      {.names = "--leak-from",
       .target = &words.leak_from,
       .help = "Tell how a walk from this world position gets out of an enclosed set",
       .value = "X,Y,Z",
       .checks = {{CheckNumbers<double, 3>}}},
      {.names = "--allow-outside",
       .target = &words.allow_outside,
       .help = "Let the walk of a region get outside; the region ends at the mesh's box"},
      {.names = "--band",
       .target = &words.band,
       .help = "Width of a band: all points within distance W of the mesh, or within W voxel sizes (Wv)",
       .value = "W|Wv",
       .checks = {{CheckBand}}},
      {.names = "--side",
       .target = &words.side,
       .help = "Ends of links that belong to --set links; for one side, the mesh must be closed",
       .words = WordsOf(SideNames()),
       .word_help = {"all", "only those inside", "only those outside"},
       .standard = "both"}};
}

std::vector<OptionRow> FieldRows(VoxelizeWords& words) {
  return {
      {.names = "--fields",
       .target = &words.fields,
       .help =
           "Values that each voxel carries, a list. From its nearest triangle: part, material, color, distance, "
           "triangle, point, normal. For each neighbor: links, link_triangles, link_crossings. For its cell, which has "
           "N^3 points: fraction:N, the number of points inside; label_fractions:N, this number for each label",
       .value = "NAME,...",
       .checks = {{CheckFields}},
       .standard = "distance for a band, otherwise none"},
      {.names = "--labels",
       .target = &words.labels,
       .help = "Make a solid, or an enclosed set, of each part or material, which voxels carry; where several overlap, "
               "see --priority",
       .words = WordsOf(LabelNames()),
       .word_help = {"each part", "each material"},
       .standard = "with --priority, the one of --fields"},
      {.names = "--priority",
       .target = &words.priority,
       .help =
           "Labels that cover the others, numbers or names, the highest first; then all others, larger numbers first",
       .value = "LABEL,...",
       .checks = {{CheckLabels}}},
      {.names = "--fraction-labels",
       .target = &words.fraction_labels,
       .help = "Labels whose label_fractions voxels carry, numbers or names, at most 32",
       .value = "LABEL,...",
       .checks = {{CheckLabels}},
       .standard = "all of the mesh, ascending"},
      {.names = "--signed",
       .target = &words.is_signed,
       .help = "Make distances negative inside; the mesh must be closed"},
      {.names = "--alpha-cutoff",
       .target = &words.alpha_cutoff,
       .help =
           "Leave out voxels whose base color is less opaque than A, 0 to 1, as holes of leaves and fences are; this "
           "lets paths through",
       .value = "A",
       .checks = {{CheckOpacity}},
       .standard = "all voxels stay"}};
}

Vec3d PositionOf(const std::string& text) {
  Vec3d position{};
  ParseNumbers(text, position);
  return position;
}

// Writes what only sets with a walk have, and refuses it for others.
void InterpretWalk(const VoxelizeWords& words, const std::string& name, VoxelSet& set) {
  auto* const enclosed = std::get_if<Enclosed>(&set);
  auto* const connected = std::get_if<Connected>(&set);
  double close = 0;
  if (!words.close.empty()) ParseNumber(words.close, close);
  if (enclosed != nullptr) {
    enclosed->close = close;
    if (!words.leak_from.empty()) enclosed->leak_from = PositionOf(words.leak_from);
  } else if (!words.leak_from.empty()) {
    Refuse("--leak-from: needs --set enclosed or enclosed-interior, not ", name);
  }
  if (connected != nullptr) {
    if (words.seed.empty()) Refuse("--set: region needs --seed X,Y,Z");
    *connected = {PositionOf(words.seed), close, words.allow_outside};
    return;
  }
  if (!words.seed.empty()) Refuse("--seed: needs --set region, not ", name);
  if (words.allow_outside) Refuse("--allow-outside: needs --set region, not ", name);
  if (enclosed == nullptr && !words.close.empty()) {
    Refuse("--close: needs --set enclosed, enclosed-interior or region, not ", name);
  }
}

// `set`: a solid or an enclosed set.
template <class Set>
void InterpretLabels(const VoxelizeWords& words, Set& set) {
  set.labels = LabelsOf(words);
  set.priority = NumbersOf(LabelWords(words.priority));
}

}  // namespace

std::vector<OptionRow> SetRows(VoxelizeWords& words) {
  std::vector<OptionRow> rows = PointRows(words);
  for (OptionRow& row : FieldRows(words)) rows.push_back(std::move(row));
  return rows;
}

VoxelSet InterpretSet(const VoxelizeWords& words) {
  const std::string name = !words.set.empty() ? words.set : words.band.empty() ? "surface" : "band";
  VoxelSet set = ValueNamed(SetNames(), name);
  if (auto* band = std::get_if<Band>(&set)) {
    if (words.band.empty()) Refuse("--set: band needs --band W");
    *band = *ParseBand(words.band);
  } else if (!words.band.empty()) {
    Refuse("--band: needs --set band, not ", name);
  }
  if (auto* links = std::get_if<Links>(&set)) {
    if (!words.side.empty()) links->side = ValueNamed(SideNames(), words.side);
  } else if (!words.side.empty()) {
    Refuse("--side: needs --set links, not ", name);
  }
  InterpretWalk(words, name, set);
  if (auto* solid = std::get_if<Solid>(&set)) {
    solid->rule = RuleOf(words);
    solid->force_open = words.force_open;
    InterpretLabels(words, *solid);
    return set;
  }
  if (auto* enclosed = std::get_if<Enclosed>(&set)) {
    InterpretLabels(words, *enclosed);
  } else if (!words.labels.empty() || !words.priority.empty()) {
    Refuse(words.labels.empty() ? "--priority" : "--labels",
           ": needs --set solid, supercover-solid, interior, enclosed or enclosed-interior, not ", name);
  }
  if (words.force_open) Refuse("--force-open: needs --set solid, supercover-solid or interior, not ", name);
  return set;
}

void InterpretFields(const VoxelizeWords& words, VoxelizeOptions& options) {
  VoxelizeRequest& request = options.request;
  if (!words.fields.empty()) {
    for (const absl::string_view word : absl::StrSplit(words.fields, ',')) {
      absl::string_view name = word;
      ConsumePoints(name, request.fraction_n);
      request.fields.push_back(ValueNamed(FieldNames(), std::string(name)));
    }
  } else if (std::holds_alternative<Band>(request.set)) {
    request.fields = {Field::kDistance};
  }
  request.fraction_labels = NumbersOf(LabelWords(words.fraction_labels));
  if (request.fraction_labels.empty()) options.fraction_labels = LabelWords(words.fraction_labels);
  InterpretBaseColors(words, options);
  if (const auto labels = LabelsOf(request.set)) {
    if (!CarriesField(request.fields, labels->field)) request.fields.push_back(labels->field);
    if (labels->priority.empty()) options.priority = LabelWords(words.priority);
  }
  request.signed_distance = words.is_signed;
  if (words.is_signed && !CarriesField(request.fields, Field::kDistance)) Refuse("--signed: needs --fields distance");
  for (const Field field : request.fields) {
    if (FactsOf(field).is_of_mesh) options.mesh.attributes.push_back(field);
  }
  InterpretRule(words, request);
  CheckOrder(options);
}

}  // namespace latvox::client
