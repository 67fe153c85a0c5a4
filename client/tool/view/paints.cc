#include "client/tool/view/paints.h"

#include <bit>
#include <cstdint>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/tool/output/labels.h"
#include "client/tool/output/legend.h"
#include "client/tool/output/voxel_colors.h"

namespace latvox::client {
namespace {

constexpr size_t kMostEntries = 24;  // in a legend

absl::Status CheckSize(const GridContent& content) {
  uint64_t paints = 0;
  for (const FieldValues& values : content.fields) paints += 1 + values.labels.size();
  const uint64_t voxels = content.file.info.active_voxels;
  if (paints == 0 || voxels <= kMaxPageColors / paints) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat(voxels, " voxels with ", paints,
                                                   " choices of colors exceed the limit of ", kMaxPageColors,
                                                   " of a page; carry fewer labels (--fraction-labels) or fields"));
}

absl::StatusOr<Paint> PaintOf(const GridContent& content, ColorBy by) {
  const auto colors = ColorsOf(content.Batch(), TraitsOf(content), by);
  if (!colors.ok()) return colors.status();
  Paint paint;
  paint.name = NameOf(by);
  const Legend legend = LegendOf(content, by, kMostEntries);
  paint.is_ramp = legend.is_ramp;
  for (const auto& [color, text] : legend.entries) {
    paint.legend.emplace_back(color ? absl::StrFormat("#%06x", *color) : "", text);
  }
  paint.bytes.reserve(3 * colors->size());
  for (const uint32_t color : *colors) {
    for (const int shift : {16, 8, 0}) paint.bytes.push_back(static_cast<char>(color >> shift & 255));
  }
  return paint;
}

std::string FourBytesEach(const FieldValues& values) {
  if (FactsOf(values.field).type != NumberType::kUint16) {
    return {reinterpret_cast<const char*>(values.bytes.data()), values.bytes.size()};
  }
  std::string bytes;
  for (const uint16_t number : values.As<uint16_t>()) {
    bytes += {static_cast<char>(number & 255), static_cast<char>(number >> 8), 0, 0};
  }
  return bytes;
}

void SetValues(const FieldValues& values, Paint& paint) {
  paint.is_mix = FactsOf(values.field).is_of_labels();
  if (paint.is_mix || values.field == Field::kColor) return;
  paint.values = FourBytesEach(FactsOf(values.field).is_of_links() ? OneOfLinks(values) : values);
  paint.has_floats = FactsOf(values.field).type == NumberType::kFloat32;
  if (!FactsOf(values.field).is_of_links()) paint.components = FactsOf(values.field).components;
}

absl::StatusOr<Paint> PaintOfLabel(const GridContent& content, const FieldValues& fractions, uint32_t label) {
  const GridContent alone{.file = {content.file.info, {}}, .fields = {FractionOf(fractions, {{label}})}};
  auto paint = PaintOf(alone, ColorBy::kFraction);
  if (!paint.ok()) return paint.status();
  const std::string name = NameOfLabel(content.file.info, label);
  paint->name = name.empty() ? FractionName(label) : absl::StrCat(FractionName(label), " (", name, ")");
  SetValues(alone.fields.front(), *paint);
  return paint;
}

}  // namespace

absl::StatusOr<std::vector<Paint>> PaintsOf(const GridContent& content) {
  if (auto status = CheckSize(content); !status.ok()) return status;
  const ColorBy first = DefaultColorBy(TraitsOf(content));
  std::vector<Paint> paints;
  const auto add = [&](absl::StatusOr<Paint> paint, bool is_first) {
    if (!paint.ok()) return paint.status();
    paints.insert(is_first ? paints.begin() : paints.end(), *std::move(paint));
    return absl::OkStatus();
  };
  for (const FieldValues& values : content.fields) {
    const ColorBy by = ByOf(values.field);
    auto paint = PaintOf(content, by);
    if (paint.ok()) SetValues(values, *paint);
    if (auto status = add(std::move(paint), by == first); !status.ok()) return status;
    for (const uint32_t label : values.labels) {
      if (auto status = add(PaintOfLabel(content, values, label), false); !status.ok()) return status;
    }
  }
  return paints;
}

}  // namespace latvox::client
