#include "client/tool/view/paints.h"

#include <bit>
#include <cstdint>

#include "absl/strings/str_format.h"
#include "client/tool/output/legend.h"
#include "client/tool/output/voxel_colors.h"

namespace latvox::client {
namespace {

constexpr size_t kMostEntries = 24;  // in a legend

// Returns nothing for a field that gives no colors.
std::optional<ColorBy> ByOf(Field field) {
  for (const ColorBy by :
       {ColorBy::kPart, ColorBy::kMaterial, ColorBy::kColor, ColorBy::kDistance, ColorBy::kFraction}) {
    if (absl::string_view(NameOf(by)) == NameOf(field)) return by;
  }
  return std::nullopt;
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

}  // namespace

absl::StatusOr<std::vector<Paint>> PaintsOf(const GridContent& content) {
  const ColorBy first = DefaultColorBy(TraitsOf(content));
  std::vector<Paint> paints;
  const auto add = [&](absl::StatusOr<Paint> paint, bool is_first) {
    if (!paint.ok()) return paint.status();
    paints.insert(is_first ? paints.begin() : paints.end(), *std::move(paint));
    return absl::OkStatus();
  };
  for (const FieldValues& values : content.fields) {
    const std::optional<ColorBy> by = ByOf(values.field);
    if (!by) continue;
    auto paint = PaintOf(content, *by);
    if (paint.ok() && by != ColorBy::kColor) {
      paint->values = FourBytesEach(values);
      paint->has_floats = FactsOf(values.field).type == NumberType::kFloat32;
    }
    if (auto status = add(std::move(paint), by == first); !status.ok()) return status;
  }
  return paints;
}

}  // namespace latvox::client
