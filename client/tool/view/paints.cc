#include "client/tool/view/paints.h"

#include <bit>
#include <cstdint>
#include <map>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/tool/output/voxel_colors.h"
#include "latvox/grid/carried_names.h"

namespace latvox::client {
namespace {

constexpr size_t kMostEntries = 24;  // in a legend
constexpr int kRampSteps = 32;

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

std::string Hex(uint32_t color) { return absl::StrFormat("#%06x", color); }

// Labels the ends and the middle.
void DescribeBand(const Band& band, Paint& paint) {
  paint.is_ramp = true;
  for (int n = 0; n <= kRampSteps; ++n) {
    const double share = static_cast<double>(n) / kRampSteps,
                 distance = band.width * (band.is_signed ? 2 * share - 1 : share);
    const bool named = n % (kRampSteps / 2) == 0;
    paint.legend.emplace_back(Hex(DistanceColor(static_cast<float>(distance), band)),
                              named ? absl::StrFormat("%.4g", distance) : "");
  }
}

// Lists parts or materials with their numbers of voxels.
void DescribeNumbers(const GridContent& content, size_t which, Paint& paint) {
  const CarriedNames names = ReadCarriedNames(content.file.info);
  std::map<uint32_t, uint64_t> counts;
  for (size_t n = which; n < content.numbers.size(); n += content.attributes.size()) ++counts[content.numbers[n]];
  for (const auto& [number, voxels] : counts) {
    if (paint.legend.size() == kMostEntries) {
      paint.legend.emplace_back("", absl::StrCat("and ", counts.size() - kMostEntries, " more"));
      break;
    }
    const std::string name = names.Of(content.attributes[which], number);
    paint.legend.emplace_back(Hex(PaletteColor(number)),
                              absl::StrCat(paint.name, " ", number, name.empty() ? "" : absl::StrCat(" (", name, ")"),
                                           ": ", voxels, " voxels"));
  }
}

template <class Number>
void AppendBytes(Number number, std::string& bytes) {
  static_assert(sizeof(number) == 4 && std::endian::native == std::endian::little);
  bytes.append(reinterpret_cast<const char*>(&number), sizeof(number));
}

absl::StatusOr<Paint> PaintOf(const BrickBatch& batch, const VoxelTraits& traits, ColorBy by) {
  const auto colors = ColorsOf(batch, traits, by);
  if (!colors.ok()) return colors.status();
  Paint paint;
  paint.name = NameOf(by);
  paint.bytes.reserve(3 * colors->size());
  for (const uint32_t color : *colors) {
    for (const int shift : {16, 8, 0}) paint.bytes.push_back(static_cast<char>(color >> shift & 255));
  }
  return paint;
}

}  // namespace

absl::StatusOr<std::vector<Paint>> PaintsOf(const GridContent& content) {
  const VoxelTraits traits{content.attributes, content.band};
  const BrickBatch batch = content.Batch();
  const ColorBy first = DefaultColorBy(traits);
  std::vector<Paint> paints;
  const auto add = [&](absl::StatusOr<Paint> paint, bool is_first) {
    if (!paint.ok()) return paint.status();
    paints.insert(is_first ? paints.begin() : paints.end(), *std::move(paint));
    return absl::OkStatus();
  };
  for (size_t n = 0; n < content.attributes.size(); ++n) {
    const ColorBy by = ByOf(content.attributes[n]);
    auto paint = PaintOf(batch, traits, by);
    if (paint.ok() && by != ColorBy::kColor) {
      DescribeNumbers(content, n, *paint);
      for (size_t at = n; at < content.numbers.size(); at += content.attributes.size()) {
        AppendBytes(content.numbers[at], paint->values);
      }
    }
    if (auto status = add(std::move(paint), by == first); !status.ok()) return status;
  }
  if (content.band) {
    auto paint = PaintOf(batch, traits, ColorBy::kDistance);
    if (paint.ok()) {
      DescribeBand(*content.band, *paint);
      for (const float distance : content.distances) AppendBytes(distance, paint->values);
    }
    if (auto status = add(std::move(paint), true); !status.ok()) return status;
  }
  return paints;
}

}  // namespace latvox::client
