#include "client/tool/output/voxel_colors.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "client/tool/output/field_columns.h"

namespace latvox::client {
namespace {

// Seven colors of Okabe and Ito (all except black), then five of Tol's "muted".
constexpr uint32_t kPalette[] = {0xE69F00, 0x56B4E9, 0x009E73, 0xF0E442, 0x0072B2, 0xD55E00,
                                 0xCC79A7, 0x332288, 0x882255, 0x999933, 0xDDCC77, 0xAA4499};

// Equal steps: signed from the greatest distance inside to the greatest outside, unsigned from the surface outward.
constexpr uint32_t kRdBu[] = {0x053061, 0x2166AC, 0x4393C3, 0x92C5DE, 0xD1E5F0, 0xF7F7F7,
                              0xFDDBC7, 0xF4A582, 0xD6604D, 0xB2182B, 0x67001F};
constexpr uint32_t kViridis[] = {0x440154, 0x472D7B, 0x3B528B, 0x2C728E, 0x21918C,
                                 0x28AE80, 0x5EC962, 0xADDC30, 0xFDE725};

constexpr uint32_t kUncrossedColor = 0xBBBBBB;  // a gray that neither the palette nor viridis has

constexpr char kFractionName[] = "latvox_fraction_n";  // of the number of points along each axis of a cell
constexpr uint32_t kLeastPoints = 2, kMostPoints = 16;

// Interpolates the colors of the map; `at` is from 0 to 1.
uint32_t Between(std::span<const uint32_t> map, double at) {
  const double place = std::clamp(at, 0.0, 1.0) * static_cast<double>(map.size() - 1);
  const size_t first = std::min(static_cast<size_t>(place), map.size() - 2);
  const double share = place - static_cast<double>(first);
  uint32_t color = 0;
  for (const int shift : {16, 8, 0}) {
    const auto level = [&](size_t n) { return static_cast<double>(map[n] >> shift & 0xFF); };
    color |= static_cast<uint32_t>(std::lround(level(first) + share * (level(first + 1) - level(first)))) << shift;
  }
  return color;
}

// Components are from 0 to 1.
uint32_t ColorOf(const std::array<float, 3>& levels) {
  uint32_t color = 0;
  for (const float level : levels) {
    color = color << 8 | static_cast<uint32_t>(std::lround(std::clamp(level, 0.0F, 1.0F) * 255));
  }
  return color;
}

// Returns the color of voxel n.
uint32_t ColorAt(const FieldValues& values, size_t n, ColorBy by, const VoxelTraits& traits) {
  switch (by) {
    case ColorBy::kDistance:
      return DistanceColor(values.As<float>()[n], *traits.distances);
    case ColorBy::kPoint: {
      const float u = values.As<float>()[2 * n], v = values.As<float>()[2 * n + 1];
      return WeightsColor({1 - u - v, u, v});
    }
    case ColorBy::kNormal: {
      const float* const normal = &values.As<float>()[3 * n];
      return NormalColor({normal[0], normal[1], normal[2]});
    }
    case ColorBy::kLinks:
      return ShareColor(values.As<float>()[n]);
    case ColorBy::kFraction:
      return FractionColor(NumberAt(values, n), traits.points_of_cell);
    case ColorBy::kLabelFractions: {
      const size_t labels = values.labels.size();
      return BlendedColor(values.labels, values.As<uint16_t>().subspan(n * labels, labels), traits.points_of_cell);
    }
    default:
      return ColorOfNumber(by, NumberAt(values, n));
  }
}

// Returns 0 where the metadata say no number that latvox writes.
uint32_t PointsOfCell(const GridFileInfo& info) {
  for (const auto& [name, text] : info.metadata) {
    uint32_t n = 0;
    if (name == kFractionName && absl::SimpleAtoi(text, &n) && n >= kLeastPoints && n <= kMostPoints) return n * n * n;
  }
  return 0;
}

static_assert(static_cast<size_t>(ColorBy::kLabelFractions) == kFields.size());

// Precondition: not kNone.
Field FieldOf(ColorBy by) { return static_cast<Field>(static_cast<int>(by) - 1); }

absl::Status Lacks(ColorBy by) { return absl::InvalidArgumentError(absl::StrCat("the voxels have no ", NameOf(by))); }

}  // namespace

const char* NameOf(ColorBy by) { return by == ColorBy::kNone ? "none" : NameOf(FieldOf(by)); }

ColorBy ByOf(Field field) { return static_cast<ColorBy>(static_cast<int>(field) + 1); }

VoxelTraits TraitsOf(const GridContent& content) {
  VoxelTraits traits{{}, content.distances, PointsOfCell(content.file.info)};
  for (const FieldValues& values : content.fields) traits.fields.push_back(values.field);
  return traits;
}

ColorBy DefaultColorBy(const VoxelTraits& traits) {
  for (const ColorBy by : {ColorBy::kColor, ColorBy::kMaterial, ColorBy::kPart}) {
    if (CarriesField(traits.fields, FieldOf(by))) return by;
  }
  return traits.distances ? ColorBy::kDistance : ColorBy::kNone;
}

uint32_t PaletteColor(uint32_t number) { return kPalette[number % std::size(kPalette)]; }

uint32_t DistanceColor(float distance, const DistanceRange& range) {
  const double share = range.most > 0 ? double{distance} / range.most : 0;
  return range.is_signed ? Between(kRdBu, (1 + share) / 2) : Between(kViridis, share);
}

FieldValues OneOfLinks(const FieldValues& links) {
  FieldValues one{links.field, {}, 1};
  const auto append = [&one](const auto& number) {
    const auto* const bytes = reinterpret_cast<const std::byte*>(&number);
    one.bytes.insert(one.bytes.end(), bytes, bytes + sizeof(number));
  };
  const size_t all = links.bytes.size() / 4;
  for (size_t n = 0; n < all; n += links.neighbors) {
    if (links.field == Field::kLinks) {
      const auto shares = links.As<float>().subspan(n, links.neighbors);
      append(std::accumulate(shares.begin(), shares.end(), std::numeric_limits<float>::quiet_NaN(),
                             [](float a, float b) { return std::fmin(a, b); }));  // NaN if both are
    } else {
      const auto numbers = links.As<uint32_t>().subspan(n, links.neighbors);
      append(links.field == Field::kLinkTriangles ? *std::ranges::min_element(numbers)
                                                  : *std::ranges::max_element(numbers));
    }
  }
  return one;
}

bool IsUncrossed(ColorBy by, uint32_t number) {
  if (by == ColorBy::kLinkTriangles) return number == std::numeric_limits<uint32_t>::max();
  return by == ColorBy::kLinkCrossings && number == 0;
}

uint32_t ColorOfNumber(ColorBy by, uint32_t number) {
  if (by == ColorBy::kColor) return number;
  return IsUncrossed(by, number) ? kUncrossedColor : PaletteColor(number);
}

uint32_t ShareColor(double share) { return std::isnan(share) ? kUncrossedColor : Between(kViridis, share); }

uint32_t FractionColor(uint32_t fraction, uint32_t points_of_cell) {
  return ShareColor(static_cast<double>(fraction) / points_of_cell);
}

uint32_t BlendedColor(std::span<const uint32_t> labels, std::span<const uint16_t> points, uint32_t points_of_cell) {
  const uint64_t of_labels = std::accumulate(points.begin(), points.end(), uint64_t{0});
  const uint64_t all = std::max<uint64_t>(of_labels, points_of_cell);
  uint32_t color = 0;
  for (const int shift : {16, 8, 0}) {
    uint64_t level = (all - of_labels) * 0xFF;
    for (size_t n = 0; n < labels.size(); ++n) level += points[n] * (PaletteColor(labels[n]) >> shift & 0xFF);
    color |= static_cast<uint32_t>((level + all / 2) / all) << shift;
  }
  return color;
}

uint32_t NormalColor(const std::array<float, 3>& normal) {
  return ColorOf({(normal[0] + 1) / 2, (normal[1] + 1) / 2, (normal[2] + 1) / 2});
}

uint32_t WeightsColor(const std::array<float, 3>& weights) { return ColorOf(weights); }

absl::StatusOr<std::vector<uint32_t>> NumbersOf(const BrickBatch& batch, ColorBy by) {
  std::vector<uint32_t> numbers;
  if (by == ColorBy::kNone) return numbers;
  const FieldValues* const values = FindField(batch.fields, FieldOf(by));
  if (values == nullptr) return Lacks(by);
  numbers.resize(values->bytes.size() / values->bytes_of_voxel());
  for (size_t n = 0; n < numbers.size(); ++n) numbers[n] = NumberAt(*values, n);
  return numbers;
}

std::optional<Warning> WarningOfMergedColors(const std::string& path, ColorBy by, size_t numbers, size_t colors) {
  if (numbers <= colors) return std::nullopt;
  return Warning{"COLORS_MERGED",
                 absl::StrCat(path, ": has ", colors, " colors for the ", numbers, " ", NameOf(by),
                              "s of the voxels, so it does not tell all of them apart"),
                 path};
}

absl::StatusOr<std::vector<uint32_t>> ColorsOf(const BrickBatch& batch, const VoxelTraits& traits, ColorBy by) {
  std::vector<uint32_t> colors;
  if (by == ColorBy::kNone) return colors;
  const FieldValues* const values = FindField(batch.fields, FieldOf(by));
  const bool of_cell = by == ColorBy::kFraction || by == ColorBy::kLabelFractions;
  const bool lacks_range = (by == ColorBy::kDistance && !traits.distances) || (of_cell && traits.points_of_cell == 0);
  if (values == nullptr || lacks_range) return Lacks(by);
  FieldValues one;
  if (FactsOf(values->field).is_of_links()) one = OneOfLinks(*values);
  const FieldValues& colored = one.neighbors > 0 ? one : *values;
  const size_t voxels = colored.bytes.size() / colored.bytes_of_voxel();
  colors.reserve(voxels);
  for (size_t n = 0; n < voxels; ++n) colors.push_back(ColorAt(colored, n, by, traits));
  return colors;
}

}  // namespace latvox::client
