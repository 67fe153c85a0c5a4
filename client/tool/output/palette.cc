#include "client/tool/output/palette.h"

#include <algorithm>
#include <array>
#include <utility>

namespace latvox::client {
namespace {

// A color, and how many voxels have it.
using Counted = std::pair<uint32_t, uint64_t>;

constexpr int kShifts[] = {16, 8, 0};

uint32_t Level(uint32_t color, int shift) { return color >> shift & 0xFF; }

// A part of the colors.
struct Group {
  std::span<Counted> colors;
  int shift = 0;        // of the component that varies most
  uint64_t weight = 0;  // voxels times that variation; 0: one color

  explicit Group(std::span<Counted> part) : colors(part) {
    uint32_t most = 0;
    for (const int each : kShifts) {
      const auto [low, high] = std::ranges::minmax_element(
          colors, {}, [each](const Counted& counted) { return Level(counted.first, each); });
      const uint32_t range = Level(high->first, each) - Level(low->first, each);
      if (range <= most) continue;
      most = range;
      shift = each;
    }
    weight = most * Voxels();
  }

  uint64_t Voxels() const {
    uint64_t voxels = 0;
    for (const Counted& counted : colors) voxels += counted.second;
    return voxels;
  }

  // Returns the size of the first half. Both halves have colors.
  size_t Halve() {
    std::ranges::sort(colors, {},
                      [this](const Counted& counted) { return std::pair(Level(counted.first, shift), counted.first); });
    const uint64_t half = Voxels() / 2;
    size_t size = 0;
    for (uint64_t voxels = 0; voxels < half || size == 0; ++size) voxels += colors[size].second;
    return std::min(size, colors.size() - 1);
  }

  uint32_t Mean() const {
    const uint64_t voxels = Voxels();
    uint32_t mean = 0;
    for (const int each : kShifts) {
      uint64_t sum = voxels / 2;
      for (const Counted& counted : colors) sum += Level(counted.first, each) * counted.second;
      mean |= static_cast<uint32_t>(sum / voxels) << each;
    }
    return mean;
  }
};

// Returns groups of similar colors: halves the heaviest one until there are enough.
std::vector<Group> MedianCut(std::span<Counted> colors, size_t most) {
  std::vector<Group> groups = {Group(colors)};
  while (groups.size() < most) {
    const auto heaviest = std::ranges::max_element(groups, {}, &Group::weight);
    if (heaviest->weight == 0) break;
    const size_t half = heaviest->Halve();
    const std::span<Counted> whole = heaviest->colors;
    *heaviest = Group(whole.first(half));
    groups.emplace_back(whole.subspan(half));
  }
  return groups;
}

}  // namespace

Palette PaletteOf(std::span<const uint32_t> colors, size_t most) {
  absl::flat_hash_map<uint32_t, uint64_t> counts;
  for (const uint32_t color : colors) ++counts[color];
  std::vector<Counted> counted(counts.begin(), counts.end());
  std::ranges::sort(counted);
  Palette palette;
  palette.number_of.reserve(counted.size());
  const auto add = [&](std::span<const Counted> group, uint32_t color) {
    for (const Counted& one : group) palette.number_of[one.first] = static_cast<uint32_t>(palette.colors.size());
    palette.colors.push_back(color);
  };
  if (counted.size() <= most) {
    for (const Counted& one : counted) add({&one, 1}, one.first);
  } else {
    for (const Group& group : MedianCut(counted, most)) add(group.colors, group.Mean());
  }
  return palette;
}

}  // namespace latvox::client
