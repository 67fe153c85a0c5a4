#include "client/tool/cli/value_difference.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "client/tool/cli/brick_pairs.h"
#include "client/tool/output/cell_index.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

// Calls visit(ijk, m, n) for every voxel of both files: the m-th of a and the n-th of b.
template <class Visit>
void ForEachCommonVoxel(const std::vector<Brick>& a, const std::vector<Brick>& b, const Visit& visit) {
  size_t m = 0, n = 0;
  ForEachPair(a, b, [&](const Brick* of_a, const Brick* of_b) {
    constexpr decltype(Brick::mask) kNone{};
    const auto &in_a = of_a ? of_a->mask : kNone, &in_b = of_b ? of_b->mask : kNone;
    Brick any{of_a ? of_a->brick_ijk : of_b->brick_ijk, {}};
    for (size_t x = 0; x < 8; ++x) any.mask[x] = in_a[x] | in_b[x];
    ForEachVoxel(any, [&](const Vec3i& ijk) {
      const bool has_a = HasVoxel(in_a, ijk), has_b = HasVoxel(in_b, ijk);
      if (has_a && has_b) visit(ijk, m, n);
      m += has_a;
      n += has_b;
    });
  });
}

}  // namespace

bool ValueDifference::equal() const {
  const auto same = [](const auto& attribute) { return attribute.second == 0; };
  return (!distances || distances->differ == 0) && std::all_of(attributes.begin(), attributes.end(), same);
}

AttributePlaces CommonAttributes(const GridContent& a, const GridContent& b) {
  AttributePlaces places;
  for (size_t m = 0; m < a.attributes.size(); ++m) {
    const auto there = std::find(b.attributes.begin(), b.attributes.end(), a.attributes[m]);
    if (there != b.attributes.end()) places.emplace_back(m, static_cast<size_t>(there - b.attributes.begin()));
  }
  return places;
}

ValueDifference CompareValues(const GridContent& a, const GridContent& b) {
  ValueDifference found;
  if (a.band && b.band) found.distances.emplace();
  const AttributePlaces places = CommonAttributes(a, b);
  for (const auto& place : places) found.attributes.emplace_back(a.attributes[place.first], 0);
  ForEachCommonVoxel(a.file.bricks, b.file.bricks, [&](const Vec3i& ijk, size_t m, size_t n) {
    if (found.distances && a.distances[m] != b.distances[n]) {
      const double difference = std::abs(double{a.distances[m]} - double{b.distances[n]});
      ++found.distances->differ;
      if (difference > found.distances->greatest) {
        found.distances->greatest = difference;
        found.distances->at = ijk;
      }
    }
    for (size_t p = 0; p < places.size(); ++p) {
      const uint32_t of_a = a.numbers[a.attributes.size() * m + places[p].first];
      found.attributes[p].second += of_a != b.numbers[b.attributes.size() * n + places[p].second];
    }
  });
  return found;
}

}  // namespace latvox::client
