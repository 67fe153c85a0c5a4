#include "client/tool/output/legend.h"

#include <algorithm>
#include <map>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/string_view.h"
#include "client/tool/output/field_columns.h"
#include "client/tool/output/labels.h"
#include "latvox/grid/carried_names.h"

namespace latvox::client {
namespace {

constexpr int kRampSteps = 32;

// Labels the ends and the middle.
//   color   of a value
template <class Color>
Legend Ramp(double least, double most, const Color& color) {
  Legend legend{.is_ramp = true};
  for (int n = 0; n <= kRampSteps; ++n) {
    const double value = least + (most - least) * n / kRampSteps;
    const bool named = n % (kRampSteps / 2) == 0;
    legend.entries.push_back({color(static_cast<float>(value)), named ? absl::StrFormat("%.4g", value) : ""});
  }
  return legend;
}

Legend LegendOfDistances(const DistanceRange& range) {
  return Ramp(range.is_signed ? -range.most : 0, range.most,
              [&range](float distance) { return DistanceColor(distance, range); });
}

Legend LegendOfNormals() {
  return {.entries = {{NormalColor({1, 0, 0}), "x"},
                      {NormalColor({0, 1, 0}), "y"},
                      {NormalColor({0, 0, 1}), "z"},
                      {NormalColor({-1, 0, 0}), "-x"},
                      {NormalColor({0, -1, 0}), "-y"},
                      {NormalColor({0, 0, -1}), "-z"}}};
}

Legend LegendOfPoints() {
  return {.entries = {{WeightsColor({1, 0, 0}), "corner 1"},
                      {WeightsColor({0, 1, 0}), "corner 2"},
                      {WeightsColor({0, 0, 1}), "corner 3"}}};
}

// `name` is that in the mesh's file, or "".
std::string Named(const std::string& number, const std::string& name) {
  return name.empty() ? number : absl::StrCat(number, " (", name, ")");
}

std::string NameOfNumber(ColorBy by, uint32_t number, const std::string& name) {
  if (by == ColorBy::kColor) return absl::StrFormat("#%06x", number);
  if (IsUncrossed(by, number)) return "no crossed link";
  return Named(absl::StrCat(NameOf(by), " ", number), name);
}

LegendEntry Rest(size_t entries) { return {std::nullopt, absl::StrCat("and ", entries, " more")}; }

// A label has as much of all cells as so many voxels.
Legend LegendOfLabels(const GridContent& content, const FieldValues& fractions, size_t most) {
  const std::span<const uint16_t> numbers = fractions.As<uint16_t>();
  const std::vector<uint32_t>& labels = fractions.labels;
  std::vector<uint64_t> points(labels.size());
  for (size_t n = 0; n < numbers.size(); ++n) points[n % labels.size()] += numbers[n];
  const double points_of_cell = TraitsOf(content).points_of_cell;
  Legend legend;
  for (size_t n = 0; n < std::min(labels.size(), most); ++n) {
    const std::string name = Named(absl::StrCat("label ", labels[n]), NameOfLabel(content.file.info, labels[n]));
    legend.entries.push_back(
        {PaletteColor(labels[n]),
         absl::StrFormat("%s: %.1f voxels", name, static_cast<double>(points[n]) / points_of_cell)});
  }
  if (labels.size() > most) legend.entries.push_back(Rest(labels.size() - most));
  legend.entries.push_back({BlendedColor({}, {}, 1), "elsewhere"});
  return legend;
}

}  // namespace

Legend LegendOf(const GridContent& content, ColorBy by, size_t most) {
  if (by == ColorBy::kDistance && content.distances) return LegendOfDistances(*content.distances);
  if (by == ColorBy::kFraction) {
    const double points = TraitsOf(content).points_of_cell;
    return Ramp(0, points, [points](float fraction) { return ShareColor(fraction / points); });
  }
  if (by == ColorBy::kLinks) return Ramp(0, 1, &ShareColor);
  if (by == ColorBy::kNormal) return LegendOfNormals();
  if (by == ColorBy::kPoint) return LegendOfPoints();
  const FieldValues* const fractions = FindField(content.fields, Field::kLabelFractions);
  if (by == ColorBy::kLabelFractions && fractions != nullptr) return LegendOfLabels(content, *fractions, most);
  Legend legend;
  const CarriedNames names = ReadCarriedNames(content.file.info);
  for (const FieldValues& values : content.fields) {
    if (absl::string_view(NameOf(values.field)) != NameOf(by)) continue;
    std::map<uint32_t, uint64_t> counts;
    FieldValues of_links;
    if (FactsOf(values.field).is_of_links()) of_links = OneOfLinks(values);
    const FieldValues& counted = of_links.neighbors > 0 ? of_links : values;
    const size_t all = counted.bytes.size() / counted.bytes_of_voxel();
    for (size_t n = 0; n < all; ++n) ++counts[NumberAt(counted, n)];
    std::vector<std::pair<uint32_t, uint64_t>> rows(counts.begin(), counts.end());
    const auto is_more = [](const auto& a, const auto& b) { return a.second > b.second; };
    if (by == ColorBy::kColor) std::stable_sort(rows.begin(), rows.end(), is_more);
    for (const auto& [number, voxels] : rows) {
      if (legend.entries.size() == most) {
        legend.entries.push_back(Rest(rows.size() - most));
        break;
      }
      legend.entries.push_back(
          {ColorOfNumber(by, number), absl::StrCat(NameOfNumber(by, number, names.Of(values.field, number)), ": ",
                                                   voxels, voxels == 1 ? " voxel" : " voxels")});
    }
  }
  return legend;
}

}  // namespace latvox::client
