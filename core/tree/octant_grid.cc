// The bounding boxes of nearly all triangles decide. A kernel finds their octants, with triangles in lanes. The few
// long triangles are tested against single octants, with separating axes.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/tree/octant_grid.cc"
#include "core/tree/octant_grid.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>

#include "core/triangles/triangle_lanes-inl.h"

// The code that does not depend on the instruction set, once.
#ifndef LATVOX_CORE_TILE_OCTANT_GRID_ONCE_
#define LATVOX_CORE_TILE_OCTANT_GRID_ONCE_

namespace latvox {
namespace {

// Octants, closed; empty if min > max on an axis.
struct OctantBox {
  Vec3i min, max;
};

OctantBox OctantsMet(const OctantGrid::Bounds& bounds, const OctantGrid::Margin& margin, const Vec3i& low,
                     const Vec3i& high) {
  OctantBox box;
  for (size_t m = 0; m < 3; ++m) {
    box.min[m] = std::max((low[m] - margin.below[m]) >> bounds.shift, bounds.lowest[m]);
    box.max[m] = std::min((high[m] + margin.above[m]) >> bounds.shift, bounds.highest[m]);
  }
  return box;
}

bool Contains(const OctantBox& box, size_t m, int32_t octant) { return box.min[m] <= octant && octant <= box.max[m]; }

// An octant's part in a hit: the bits of its coordinate, three apart, at the places of the axis in Morton order.
int32_t HitPart(size_t axis, int32_t octant) {
  int32_t part = 0;
  for (int bit = 0; bit < kMaxGridLevels; ++bit) part |= (octant >> bit & 1) << 3 * bit;
  return part << (3 - axis);
}

void PlainEncode(const OctantGrid::Bounds& bounds, const SnappedMesh& mesh, std::span<const uint32_t> triangles,
                 OctantGrid::Codes& out) {
  for (size_t n = 0; n < triangles.size(); ++n) {
    const auto& [i, j, k] = mesh.triangles[triangles[n]];
    const Vec3i &a = mesh.vertices_lat[i], &b = mesh.vertices_lat[j], &c = mesh.vertices_lat[k];
    Vec3i low, high;
    for (size_t m = 0; m < 3; ++m) {
      low[m] = std::min({a[m], b[m], c[m]});
      high[m] = std::max({a[m], b[m], c[m]});
    }
    const OctantBox near = OctantsMet(bounds, bounds.near, low, high), far = OctantsMet(bounds, bounds.far, low, high);
    OctantGrid::Code& code = out.of[n] = {};
    bool is_long = false, several = false, three = false, none = false;
    for (size_t m = 0; m < 3; ++m) {
      const auto part = [&](int32_t octant) {
        return static_cast<uint16_t>(HitPart(m, octant) | (Contains(near, m, octant) ? 0 : 1));
      };
      code.part[m] = {part(far.min[m]), part(far.max[m])};
      const int32_t more = far.max[m] - far.min[m];
      code.two |= static_cast<uint16_t>((more & 1) << (2 - m));
      is_long |= high[m] - low[m] >= 1 << bounds.shift;
      several |= (low[m] - bounds.far.below[m]) >> bounds.shift < (high[m] + bounds.far.above[m]) >> bounds.shift;
      three |= more > 1;
      none |= more < 0;
    }
    code.is_many = !none && (three || (is_long && several)) ? 1 : 0;
    if (none) code = {{{static_cast<uint16_t>(bounds.no_hit), 0}, {}, {}}, 0, 0};
  }
}

size_t PlainFewHits(const OctantGrid::Codes& codes, size_t n, OctantHit*& end) {
  for (; n < codes.size && codes.of[n].is_many == 0; ++n) {
    const OctantGrid::Code& code = codes.of[n];
    int32_t subset = 0;  // of the axes with two octants: those where it is the highest
    do {
      int32_t hit = 0;
      for (size_t m = 0; m < 3; ++m) {
        hit |= (subset >> (2 - m) & 1) != 0 ? code.part[m].highest : code.part[m].lowest;
      }
      *end++ = static_cast<OctantHit>(hit);
      subset = (subset - code.two) & code.two;
    } while (subset != 0);
    end[-1] |= kLastHit;
  }
  return n;
}

// For each `two`, the shuffle that puts a code's hits side by side: bytes of the code for each axis, marks, their
// number.
struct Placement {
  alignas(16) uint8_t bytes[3][16];
  alignas(16) OctantHit marks[8];
  size_t count;
};

constexpr std::array<Placement, 8> MakePlacements() {
  std::array<Placement, 8> all{};
  for (size_t two = 0; two < 8; ++two) {
    Placement& of = all[two];
    for (size_t subset = 0; subset < 8; ++subset) {
      if ((subset & ~two) != 0) continue;
      for (size_t m = 0; m < 3; ++m) {
        const size_t from = 4 * m + 2 * (subset >> (2 - m) & 1);
        of.bytes[m][2 * of.count] = static_cast<uint8_t>(from);
        of.bytes[m][2 * of.count + 1] = static_cast<uint8_t>(from + 1);
      }
      ++of.count;
    }
    of.marks[of.count - 1] = kLastHit;
  }
  return all;
}

constexpr std::array<Placement, 8> kPlacements = MakePlacements();
static_assert(sizeof(OctantGrid::Code) == 16);

}  // namespace
}  // namespace latvox

#endif  // LATVOX_CORE_TILE_OCTANT_GRID_ONCE_

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR  // which has no vectors of four

void Encode(const OctantGrid::Bounds& bounds, const SnappedMesh& mesh, const PaddedVertices&,
            std::span<const uint32_t> triangles, OctantGrid::Codes& out) {
  PlainEncode(bounds, mesh, triangles, out);
}

size_t FewHits(const OctantGrid::Codes& codes, size_t first, OctantHit*& end) {
  return PlainFewHits(codes, first, end);
}

#else

namespace hn = hwy::HWY_NAMESPACE;
static_assert(OctantGrid::kBlock % kTriangleLanes == 0);

void Encode(const OctantGrid::Bounds& bounds, const SnappedMesh& mesh, const PaddedVertices& vertices,
            std::span<const uint32_t> triangles, OctantGrid::Codes& out) {
  const Lanes d;
  const hn::RebindToUnsigned<Lanes> du;
  const Ints almost_an_octant = Fill((1 << bounds.shift) - 1);
  const auto octant = [&](Ints v) HWY_ATTR { return hn::ShiftRightSame(v, bounds.shift); };
  const auto bit_if_negative = [&](Ints v) HWY_ATTR { return hn::BitCast(d, hn::ShiftRight<31>(hn::BitCast(du, v))); };
  // See HitPart. Octants have four bits: 3210 -> 32....10 -> 3..2..1..0. Two at a time, side by side.
  const auto hit_parts = [&](size_t axis, Ints octants) HWY_ATTR {
    octants = hn::And(hn::Or(octants, hn::ShiftLeft<4>(octants)), Fill(0x00C300C3));
    octants = hn::And(hn::Or(octants, hn::ShiftLeft<2>(octants)), Fill(0x02490249));
    return hn::ShiftLeftSame(octants, 3 - static_cast<int>(axis));
  };
  for (size_t n = 0; n < triangles.size(); n += kTriangleLanes) {
    const std::array<Ints3, 3> v = LoadCorners(mesh, vertices, LaneNumbers(triangles.subspan(n)), {});
    Ints3 parts;
    // Less than 0 if true on an axis; and `two`, as in codes.
    Ints is_long = hn::Zero(d), several = is_long, three = is_long, none = is_long, two = is_long;
    for (size_t m = 0; m < 3; ++m) {
      const auto near_below = Fill(bounds.near.below[m]), near_above = Fill(bounds.near.above[m]);
      const auto far_below = Fill(bounds.far.below[m]), far_above = Fill(bounds.far.above[m]);
      const Ints lowest = Fill(bounds.lowest[m]), highest = Fill(bounds.highest[m]);
      const Ints low = Least(v[0][m], v[1][m], v[2][m]), high = Most(v[0][m], v[1][m], v[2][m]);
      const Ints near_min = octant(hn::Sub(low, near_below)), near_max = octant(hn::Add(high, near_above));
      const Ints first = octant(hn::Sub(low, far_below)), last = octant(hn::Add(high, far_above));
      const Ints far_min = hn::Max(first, lowest), far_max = hn::Min(last, highest);
      const auto fringe = [&](Ints place) HWY_ATTR {
        return bit_if_negative(hn::Or(hn::Sub(place, near_min), hn::Sub(near_max, place)));
      };
      parts[m] = hn::Or(hit_parts(m, hn::Or(far_min, hn::ShiftLeft<16>(far_max))),
                        hn::Or(fringe(far_min), hn::ShiftLeft<16>(fringe(far_max))));
      const Ints more = hn::Sub(far_max, far_min);
      two = hn::Or(hn::Add(two, two), more);
      is_long = hn::Or(is_long, hn::Sub(almost_an_octant, hn::Sub(high, low)));
      several = hn::Or(several, hn::Sub(first, last));
      three = hn::Or(three, hn::Sub(Fill(1), more));
      none = hn::Or(none, more);
    }
    const Ints is_many = hn::AndNot(none, hn::Or(three, hn::And(is_long, several)));
    const Ints last_part = hn::Or(hn::And(two, Fill(7)), hn::And(hn::BroadcastSignBit(is_many), Fill(1 << 16)));
    const auto any = hn::Not(hn::Lt(none, hn::Zero(d)));
    hn::StoreInterleaved4(hn::IfThenElse(any, parts[0], Fill(bounds.no_hit)), hn::IfThenElseZero(any, parts[1]),
                          hn::IfThenElseZero(any, parts[2]), hn::IfThenElseZero(any, last_part), d,
                          reinterpret_cast<int32_t*>(&out.of[n]));
  }
}

// Has no branch for the axes with two octants, because it would be hard to predict.
size_t FewHits(const OctantGrid::Codes& codes, size_t n, OctantHit*& end) {
  const hn::FixedTag<uint8_t, 16> d8;
  const hn::FixedTag<OctantHit, 8> d;
  OctantHit* next = end;
  for (; n < codes.size && codes.of[n].is_many == 0; ++n) {
    const Placement& placement = kPlacements[codes.of[n].two];
    const auto code = hn::LoadU(d8, reinterpret_cast<const uint8_t*>(&codes.of[n]));
    const auto parts = [&](size_t m) HWY_ATTR { return hn::TableLookupBytes(code, hn::Load(d8, placement.bytes[m])); };
    const auto hits = hn::BitCast(d, hn::Or(hn::Or(parts(0), parts(1)), parts(2)));
    hn::StoreU(hn::Or(hits, hn::Load(d, placement.marks)), d, next);
    next += placement.count;
  }
  end = next;
  return n;
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <cmath>

#include "core/base/simd.h"

namespace latvox {
namespace {

// For rounding; one more triangle does no harm. Coordinates are below 2^27 in size, and boxes are at least 2^14 wide.
// So the errors of projections are below 2^-30 of radii.
constexpr double kSlack = 1 + 0x1p-20;

// The interval of a triangle's projections to one axis.
struct Axis {
  Vec3d direction;
  double min, max;
};

}  // namespace

// The separating axes between a triangle and a box, except the box's own.
class OctantGrid::LongTriangle {
 public:
  LongTriangle(const OctantGrid& grid, const std::array<Vec3i, 3>& corners) : grid_(grid) {
    std::array<Vec3d, 3> v;  // relative to the grid
    for (size_t n = 0; n < 3; ++n) {
      for (size_t m = 0; m < 3; ++m) v[n][m] = static_cast<double>(corners[n][m] - grid.low_[m]);
    }
    const std::array<Vec3d, 3> edges{v[1] - v[0], v[2] - v[1], v[0] - v[2]};
    size_t count = 0;
    const auto add = [&](const Vec3d& direction) {
      const double p0 = Dot(direction, v[0]), p1 = Dot(direction, v[1]), p2 = Dot(direction, v[2]);
      axes_[count++] = {direction, std::min({p0, p1, p2}), std::max({p0, p1, p2})};
    };
    add(Cross(edges[0], edges[1]));
    for (const Vec3d& e : edges) {
      add({0, -e[2], e[1]});
      add({e[2], 0, -e[0]});
      add({-e[1], e[0], 0});
    }
  }

  // Halves boxes of octants that the triangle may come near to, down to single octants.
  void Descend(const OctantBox& octants, const OctantBox& near, std::vector<OctantHit>& hits) const {
    size_t axis = 0;
    int32_t longest = 0, count = 1;
    for (size_t m = 0; m < 3; ++m) {
      const int32_t side = octants.max[m] - octants.min[m] + 1;
      if (side <= 0) return;
      count *= side;
      if (side > longest) {
        longest = side;
        axis = m;
      }
    }
    if (count == 1) return Add(octants, near, hits);
    constexpr int32_t kFew = 4;  // octants; with fewer, it does not pay to test them together
    if (count > kFew && !Meets(octants, grid_.far_margin_)) return;
    OctantBox lower = octants, upper = octants;
    lower.max[axis] = octants.min[axis] + longest / 2 - 1;
    upper.min[axis] = lower.max[axis] + 1;
    Descend(lower, near, hits);
    Descend(upper, near, hits);
  }

 private:
  // Returns whether the triangle may come within `margin` of the box of octants, as far as these axes show.
  bool Meets(const OctantBox& octants, const Vec3i& margin) const {
    const double side = 1 << grid_.bounds_.shift;
    Vec3d center, half;
    for (size_t m = 0; m < 3; ++m) {
      const double low = octants.min[m] * side, high = (octants.max[m] + 1) * side;
      center[m] = (low + high) / 2;
      half[m] = (high - low) / 2 + margin[m];
    }
    for (const Axis& axis : axes_) {
      const double at = Dot(axis.direction, center);
      double radius = 0;
      for (size_t m = 0; m < 3; ++m) radius += std::abs(axis.direction[m]) * half[m];
      radius *= kSlack;
      if (axis.min > at + radius || axis.max < at - radius) return false;
    }
    return true;
  }

  void Add(const OctantBox& octant, const OctantBox& near, std::vector<OctantHit>& hits) const {
    int32_t hit = 0;
    bool is_near = true;
    for (size_t m = 0; m < 3; ++m) {
      hit |= HitPart(m, octant.min[m]);
      is_near &= Contains(near, m, octant.min[m]);
    }
    if (is_near && Meets(octant, grid_.near_margin_)) {
      hits.push_back(static_cast<OctantHit>(hit));
    } else if (Meets(octant, grid_.far_margin_)) {
      hits.push_back(static_cast<OctantHit>(hit | 1));
    }
  }

  const OctantGrid& grid_;
  std::array<Axis, 10> axes_;
};

OctantGrid::OctantGrid(const Vec3i& tile_ijk, int level, int levels, const Vec3i& near, const Vec3i& far,
                       const IndexBox& region)
    : low_(tile_ijk * (kTileSide * kLatticeUnit)), near_margin_(near * kLatticeUnit), far_margin_(far * kLatticeUnit) {
  const int voxel_shift = level - levels + kTileBits;
  bounds_.shift = voxel_shift + kSubvoxelBits;
  for (size_t m = 0; m < 3; ++m) {
    // A closed box [low, high] meets the closed octants [c * side - margin, (c + 1) * side + margin]. These are the
    // octants with
    //   (low - margin) / side - 1 <= c <= (high + margin) / side.
    const auto set = [&](Margin& margin, int32_t width) {
      margin.below[m] = low_[m] + width + 1;
      margin.above[m] = width - low_[m];
    };
    set(bounds_.near, near_margin_[m]);
    set(bounds_.far, far_margin_[m]);
    const int32_t low_voxel = tile_ijk[m] * kTileSide;
    bounds_.lowest[m] = std::max(0, (region.min[m] - low_voxel) >> voxel_shift);
    bounds_.highest[m] = std::min((1 << levels) - 1, (region.max[m] - 1 - low_voxel) >> voxel_shift);
  }
  bounds_.no_hit = 2 << 3 * levels;
}

bool OctantGrid::IsEmpty() const {
  bool empty = false;
  for (size_t m = 0; m < 3; ++m) empty |= bounds_.lowest[m] > bounds_.highest[m];
  return empty;
}

std::vector<OctantHit> OctantGrid::ManyHits(const std::array<Vec3i, 3>& corners) const {
  Vec3i low, high;
  for (size_t m = 0; m < 3; ++m) {
    low[m] = std::min({corners[0][m], corners[1][m], corners[2][m]});
    high[m] = std::max({corners[0][m], corners[1][m], corners[2][m]});
  }
  const OctantBox near = OctantsMet(bounds_, bounds_.near, low, high),
                  far = OctantsMet(bounds_, bounds_.far, low, high);
  std::vector<OctantHit> hits;
  LongTriangle(*this, corners).Descend(far, near, hits);
  return hits;
}

HWY_EXPORT(Encode);
HWY_EXPORT(FewHits);

void OctantGrid::Encode(const SnappedMesh& mesh, const PaddedVertices& vertices, std::span<const uint32_t> triangles,
                        Codes& out) const {
  out.size = triangles.size();
  if (SimdIsScalar()) return PlainEncode(bounds_, mesh, triangles, out);
  HWY_DYNAMIC_DISPATCH(Encode)(bounds_, mesh, vertices, triangles, out);
}

size_t OctantGrid::FewHits(const Codes& codes, size_t first, OctantHit*& end) {
  if (SimdIsScalar()) return PlainFewHits(codes, first, end);
  return HWY_DYNAMIC_DISPATCH(FewHits)(codes, first, end);
}

}  // namespace latvox

#endif  // HWY_ONCE
