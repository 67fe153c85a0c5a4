#include "client/tool/cli/value_difference.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "client/tool/cli/brick_pairs.h"
#include "client/tool/output/cell_index.h"
#include "client/tool/output/field_columns.h"
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

// Adds the links of the m-th voxel of a and the n-th of b.
void AddLinks(const CommonField& links, size_t m, size_t n, LinkDifference& found) {
  const size_t neighbors = links.a->neighbors;
  for (size_t q = 0; q < neighbors; ++q) {
    const double difference = double{links.a->As<float>()[m * neighbors + q]} - links.b->As<float>()[n * neighbors + q];
    if (!std::isnan(difference)) found.greatest = std::max(found.greatest, std::abs(difference));
    found.crossed_in_one += IsCrossed(*links.a, m * neighbors + q) != IsCrossed(*links.b, n * neighbors + q);
  }
}

}  // namespace

bool CommonField::Differs(size_t m, size_t n) const {
  return std::memcmp(BytesAt(*a, m), BytesAt(*b, n), a->bytes_of_voxel()) != 0;
}

bool ValueDifference::equal() const {
  const auto same = [](const auto& field) { return field.second == 0; };
  return (!distances || distances->differ == 0) && std::all_of(others.begin(), others.end(), same);
}

std::vector<CommonField> CommonFields(const GridContent& a, const GridContent& b) {
  std::vector<CommonField> fields;
  for (const FieldValues& of_a : a.fields) {
    const FieldValues* const of_b = FindField(b.fields, of_a.field);
    if (of_b == nullptr || of_a.labels != of_b->labels) continue;
    if (FactsOf(of_a.field).is_of_links() && a.neighbors != b.neighbors) continue;
    fields.push_back({&of_a, of_b});
  }
  return fields;
}

ValueDifference CompareValues(const GridContent& a, const GridContent& b) {
  ValueDifference found;
  const std::vector<CommonField> fields = CommonFields(a, b);
  std::vector<uint64_t> differ(fields.size(), 0);
  DistanceDifference distances;
  LinkDifference links;
  ForEachCommonVoxel(a.file.bricks, b.file.bricks, [&](const Vec3i& ijk, size_t m, size_t n) {
    for (size_t f = 0; f < fields.size(); ++f) {
      if (!fields[f].Differs(m, n)) continue;
      ++differ[f];
      if (fields[f].a->field == Field::kLinks) AddLinks(fields[f], m, n, links);
      if (fields[f].a->field != Field::kDistance) continue;
      const double of_a = fields[f].a->As<float>()[m], difference = std::abs(of_a - fields[f].b->As<float>()[n]);
      if (difference <= distances.greatest) continue;
      distances.greatest = difference;
      distances.at = ijk;
    }
  });
  for (size_t f = 0; f < fields.size(); ++f) {
    if (fields[f].a->field == Field::kDistance) {
      distances.differ = differ[f];
      found.distances = distances;
    } else {
      if (fields[f].a->field == Field::kLinks) found.links = links;
      found.others.emplace_back(fields[f].a->field, differ[f]);
    }
  }
  return found;
}

}  // namespace latvox::client
