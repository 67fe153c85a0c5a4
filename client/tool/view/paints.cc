#include "client/tool/view/paints.h"

#include <bit>
#include <cstdint>

#include "absl/strings/str_format.h"
#include "client/tool/output/legend.h"
#include "client/tool/output/voxel_colors.h"

namespace latvox::client {
namespace {

constexpr size_t kMostEntries = 24;  // in a legend

ColorBy ByOf(Attribute attribute) {
  switch (attribute) {
    case Attribute::kPart:
      return ColorBy::kPart;
    case Attribute::kMaterial:
      return ColorBy::kMaterial;
    case Attribute::kColor:
      return ColorBy::kColor;
  }
  return ColorBy::kNone;
}

template <class Number>
void AppendBytes(Number number, std::string& bytes) {
  static_assert(sizeof(number) == 4 && std::endian::native == std::endian::little);
  bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
}

absl::StatusOr<Paint> PaintOf(const GridContent& content, ColorBy by) {
  const auto colors = ColorsOf(content.Batch(), {content.attributes, content.band}, by);
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

}  // namespace

absl::StatusOr<std::vector<Paint>> PaintsOf(const GridContent& content) {
  const ColorBy first = DefaultColorBy({content.attributes, content.band});
  std::vector<Paint> paints;
  const auto add = [&](absl::StatusOr<Paint> paint, bool is_first) {
    if (!paint.ok()) return paint.status();
    paints.insert(is_first ? paints.begin() : paints.end(), *std::move(paint));
    return absl::OkStatus();
  };
  for (size_t n = 0; n < content.attributes.size(); ++n) {
    const ColorBy by = ByOf(content.attributes[n]);
    auto paint = PaintOf(content, by);
    if (paint.ok() && by != ColorBy::kColor) {
      for (size_t at = n; at < content.numbers.size(); at += content.attributes.size()) {
        AppendBytes(content.numbers[at], paint->values);
      }
    }
    if (auto status = add(std::move(paint), by == first); !status.ok()) return status;
  }
  if (content.band) {
    auto paint = PaintOf(content, ColorBy::kDistance);
    if (paint.ok()) {
      for (const float distance : content.distances) AppendBytes(distance, paint->values);
    }
    if (auto status = add(std::move(paint), true); !status.ok()) return status;
  }
  return paints;
}

}  // namespace latvox::client
