#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/supercover/short_cover.cc"
#include "core/supercover/short_cover.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/supercover/cut_triangle.h"
#include "core/supercover/row_lanes-inl.h"

namespace latvox {
#ifndef LATVOX_CORE_SUPERCOVER_SHORT_COVER_CC_ONCE
#define LATVOX_CORE_SUPERCOVER_SHORT_COVER_CC_ONCE
namespace {

// A number for each edge of a triangle, or for each corner; the last one is that of the first. A vector of the
// compiler: it needs no loop where the processor's vectors have two doubles.
using Four = double __attribute__((vector_size(32)));
using Four3 = std::array<Four, 3>;

struct ShortTriangle {
  Four3 v;         // corners, lattice units, relative to the base
  Vec3d normal;    // not 0
  double max_row;  // of rows, relative to the base
};

}  // namespace
#endif
}  // namespace latvox

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

// Adds half-spaces with normals (i, j, k), those with `wanted`. Half a lattice unit decides ties: see RowBounds.
// Returns false if doubles are not good enough for one of them.
HWY_INLINE bool Add(const Four3& normal, const Four& room_lat, const std::array<bool, 4>& wanted, double max_row,
                    RowBounds::Sides& sides) {
  const auto& [i, j, k] = normal;
  const Four room = (room_lat + 0.5) * (1.0 / kLatticeUnit), size = k < 0 ? -k : k;
  const Four inverse = 1 / (size + (size == 0 ? Four{} + 1 : Four{}));
  const Four rooms = room * inverse, is = i * inverse, js = j * inverse;
  const Four most = (rooms < 0 ? -rooms : rooms) + ((is < 0 ? -is : is) + (js < 0 ? -js : js)) * max_row;
  bool good = true;
  for (size_t n = 0; n < 4; ++n) {
    if (!wanted[n]) continue;
    RowBounds::Side& side = k[n] > 0 ? sides.upper : k[n] < 0 ? sides.lower : sides.flat;
    side.Add(rooms[n], is[n], js[n]);
    good &= most[n] < RowBounds::kMaxTerm || k[n] == 0;
  }
  return good;
}

HWY_INLINE bool AddFacets(const ShortCover::Constants& cell, const ShortTriangle& triangle, RowBounds::Sides& sides) {
  bool good = true;
  for (const ShortCover::Facet& facet : cell.facets) {
    const auto [i, j, k] = facet.normal;
    const Four at = i * triangle.v[0] + j * triangle.v[1] + k * triangle.v[2];
    const double most = std::max(std::max(at[0], at[1]), at[2]), least = std::min(std::min(at[0], at[1]), at[2]);
    good &= Add({Four{i, -i}, Four{j, -j}, Four{k, -k}}, Four{most, -least} + facet.reach, {true, true},
                triangle.max_row, sides);
  }
  return good;
}

HWY_INLINE bool AddPlane(const ShortCover::Constants& cell, const ShortTriangle& triangle, RowBounds::Sides& sides) {
  const auto [i, j, k] = triangle.normal;
  double support = 0;
  for (const Vec3d& direction : cell.directions) support += std::abs(Dot(triangle.normal, direction));
  double reach = std::floor(support / cell.twice_determinant);
  // The quotient's rounding may have passed an integer.
  reach -= reach * cell.twice_determinant > support ? 1 : 0;
  reach += (reach + 1) * cell.twice_determinant <= support ? 1 : 0;
  const double at = i * triangle.v[0][0] + j * triangle.v[1][0] + k * triangle.v[2][0];
  return Add({Four{i, -i}, Four{j, -j}, Four{k, -k}}, Four{at, -at} + reach, {true, true}, triangle.max_row, sides);
}

HWY_INLINE bool AddEdges(const ShortCover::Constants& cell, const ShortTriangle& triangle, RowBounds::Sides& sides) {
  Four3 d, to_other;
  for (size_t m = 0; m < 3; ++m) {
    const Four v = triangle.v[m];
    d[m] = Four{v[1], v[2], v[0], v[1]} - v;
    to_other[m] = Four{v[2], v[0], v[1], v[2]} - v;
  }
  bool good = true;
  for (const ShortCover::Rim& rim : cell.rims) {
    Four3 normal;
    for (size_t r = 0; r < 3; ++r) {
      normal[r] = rim.normal[r][0] * d[0] + rim.normal[r][1] * d[1] + rim.normal[r][2] * d[2];
    }
    Four reach{};
    for (size_t u = 0; u < rim.zones; ++u) {
      const Four along = rim.along[u][0] * d[0] + rim.along[u][1] * d[1] + rim.along[u][2] * d[2];
      reach += along < 0 ? -along : along;
    }
    const Four across = normal[0] * to_other[0] + normal[1] * to_other[1] + normal[2] * to_other[2];
    const Four sign = across < 0 ? Four{} + 1 : Four{} - 1;
    for (Four& x : normal) x *= sign;
    const Four at = normal[0] * triangle.v[0] + normal[1] * triangle.v[1] + normal[2] * triangle.v[2];
    // Without those that are parallel to the plane.
    good &= Add(normal, at + reach, {across[0] != 0, across[1] != 0, across[2] != 0}, triangle.max_row, sides);
  }
  return good;
}

bool FindRuns(const ShortCover::Constants& cell, const ShortTriangle& triangle, const Vec3i& base, const IndexBox& box,
              ShortCover::Run run, ShortCover::Decide decide) {
  RowBounds::Sides sides;
  if (!AddPlane(cell, triangle, sides) || !AddFacets(cell, triangle, sides) || !AddEdges(cell, triangle, sides)) {
    return false;
  }
  const Interval all{box.min[2], box.max[2] - 1};
  for (int32_t i = box.min[0]; i < box.max[0]; ++i) {
    for (int32_t j = box.min[1]; j < box.max[1]; j += RowBounds::kRows) {
      RowBounds::Rows rows;
      const auto count = static_cast<size_t>(std::min(box.max[1] - j, RowBounds::kRows));
      FindRows(sides, i, j, count, all, rows);
      for (size_t n = 0; n < count; ++n) {
        const int32_t row = j + static_cast<int32_t>(n);
        Interval k{rows.first[n], rows.last[n]};
        if (k.last == RowBounds::kDoubtful) k = decide(i, row);
        if (k.first <= k.last) run(base + Vec3i{i, row, k.first}, k.last - k.first + 1);
      }
    }
  }
  return true;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace latvox {
namespace {

HWY_EXPORT(FindRuns);

using Vec3l = Vec<int64_t, 3>;

// normal = G a and along . d = p_u e_u . a are linear in d, by a = (G d) x e.
ShortCover::Rim RimOf(const IntegerCell& cell, const CellZone& zone) {
  ShortCover::Rim rim;
  for (size_t m = 0; m < 3; ++m) {
    const Vec3l a = Cross(cell.form()[m], Vec3l{zone.e[0], zone.e[1], zone.e[2]});  // for the m-th unit vector d
    rim.zones = 0;
    for (const CellZone& u : cell.zones()) {
      if (u.e == zone.e) continue;  // across a
      const auto along = static_cast<double>(Dot(a, u.e) * u.length);
      for (size_t r = 0; r < 3; ++r) rim.normal[r][m] += along * u.e[r];
      rim.along[rim.zones++][m] = along * (kLatticeUnit / 2);
    }
  }
  return rim;
}

}  // namespace

// The support's numerator has 3b + 2D + 21 bits: U * sum p (normal . direction), with directions of 2b + 7 bits.
ShortCover::ShortCover(const IntegerCell& cell)
    : most_bits_(std::min({(51 - 21 - 3 * cell.length_bits()) / 2, (51 - 17) / 2 - cell.length_bits(), (51 - 4) / 3})) {
  if (most_bits_ <= kSubvoxelBits) return;
  const Mat<int64_t, 3>& g = cell.form();
  const Mat<int64_t, 3> adjugate{Cross(g[1], g[2]), Cross(g[2], g[0]), Cross(g[0], g[1])};
  constants_.twice_determinant = static_cast<double>(2 * Dot(g[0], adjugate[0]));
  for (const CellZone& zone : cell.zones()) {
    constants_.rims.push_back(RimOf(cell, zone));
    constants_.directions.push_back(ToDouble(Apply(adjugate, zone.e) * (zone.length * kLatticeUnit)));
  }
  for (const Vec3i& w : cell.facets()) {
    Facet facet{ToDouble(Apply(g, w)), 0};
    if (std::ranges::count(facet.normal, 0.0) == 2) continue;  // the rows' box has these
    for (const CellZone& zone : cell.zones()) {
      facet.reach += static_cast<double>(zone.length * std::abs(Dot(zone.e, w)) * (kLatticeUnit / 2));
    }
    constants_.facets.push_back(facet);
  }
}

bool ShortCover::ForEachRun(const Triangle& triangle, const Vec3i& base, const IndexBox& rows, Run run,
                            Decide decide) const {
  ShortTriangle corners;
  std::array<Vec3d, 3> v;
  for (size_t n = 0; n < 3; ++n) v[n] = ToDouble(triangle[n] - base * kLatticeUnit);
  for (size_t m = 0; m < 3; ++m) corners.v[m] = Four{v[0][m], v[1][m], v[2][m], v[0][m]};
  corners.normal = Cross(v[1] - v[0], v[2] - v[0]);
  if (corners.normal == Vec3d{}) return false;
  corners.max_row = 0;
  for (size_t m = 0; m < 2; ++m) {
    corners.max_row = std::max<double>(corners.max_row, std::max(std::abs(rows.min[m]), std::abs(rows.max[m])));
  }
  return HWY_DYNAMIC_DISPATCH(FindRuns)(constants_, corners, base, rows, run, decide);
}

}  // namespace latvox
#endif  // HWY_ONCE
