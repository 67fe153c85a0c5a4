// Triangles in lanes of 16 bits.
//
// A triangle meets the only cell of its box. It also meets both of two, because it is connected. For larger boxes, let
// P be the corner where the low cells of all axes end. The triangle meets a cell of the box iff it meets the closed
// octant of space around P that holds the cell. The separating axes of an octant and a triangle are
// - the lattice axes, which separate no cell of the box,
// - the normals n of the edges in the projections along each axis. For an edge from (x, y) to (x', y'), as seen from P,
//     n = (y' - y, x - x'),   n.v = x y' - x' y = e at its corners v,   n.v = e - D at the third corner,
//   where D is the sum of e over the three edges,
// - the normal N of the triangle. Its components are the D of the projections, and N.v is the same for all corners.
// Along such a vector, the octant with the vector's signs reaches from 0 up, and the opposite octant from 0 down. All
// others reach both ways. So the vector separates the first one if all products are below 0, the opposite one if all
// are above 0, and no other. A component of 0 may have either sign. Cells and triangles are closed, so there are no
// ties, and triangles without area are no exception.
//
// With U = kLatticeUnit, |x|, |y| <= U, |e| <= 2 U^2, |D| <= 6 U^2 and |N.v| <= 18 U^3 < 2^29. So all signs are exact.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/tiny/tiny_cover.cc"
#define HWY_WANT_AVX3_DL  // for compressing lanes of 16 bits
#include "core/tiny/tiny_cover.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "core/base/append_lanes-inl.h"
#include "core/triangles/corner_list-inl.h"

namespace latvox {
#ifndef LATVOX_CORE_TINY_TINY_COVER_CC_ONCE
#define LATVOX_CORE_TINY_TINY_COVER_CC_ONCE
namespace {

constexpr size_t kOctants = 8;

// Cells, counted as voxels of CornerList are. Whole vectors can be read and written. The first one is below all tiles,
// so that each of the others has one before it.
struct CellList {
  static constexpr size_t kMost = 1 + kOctants * CornerList::kMost, kSlack = 64;
  static constexpr auto kBelow = static_cast<uint16_t>(CornerList::kFirstVoxel - 1);

  size_t size = 1;
  uint16_t at[3][kMost + kSlack] = {{kBelow}, {kBelow}, {kBelow}};
};

// The octants on the high side of each axis: bit m of an octant's number says whether it is there.
constexpr std::array<int, 3> kHighSide{0xAA, 0xCC, 0xF0};
constexpr int kAllOctants = 0xFF;

}  // namespace
#endif
}  // namespace latvox

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR  // which treats no triangle as tiny
void FindCells(const CornerList&, CellList&, std::vector<uint32_t>&) {}
void PackCells(const CellList&, const IndexBox&, PackedLinks&) {}
#else

namespace hn = hwy::HWY_NAMESPACE;

using ShortLanes = hn::ScalableTag<int16_t>;
using Shorts = hn::Vec<ShortLanes>;
using Shorts3 = std::array<Shorts, 3>;
using ShortMask = hn::Mask<ShortLanes>;
constexpr size_t kCoverLanes = 2 * kTriangleLanes;
static_assert(kCoverLanes <= CellList::kSlack && kCoverLanes <= CornerList::kSlack);

HWY_INLINE Shorts FillShort(int n) { return hn::Set(ShortLanes(), static_cast<int16_t>(n)); }

// All bits of negative lanes.
HWY_INLINE Shorts Negative(Shorts v) { return hn::ShiftRight<15>(v); }

// The boxes of cells of some triangles, from the voxels of their first corners on. See BoxOfCells.
struct CellBoxes {
  Shorts3 first, more;  // the lowest cell, and the number of others along each axis

  HWY_INLINE explicit CellBoxes(const ShortCorners<ShortLanes>& v) {
    constexpr int kHalf = kLatticeUnit / 2;
    for (size_t m = 0; m < 3; ++m) {
      const Shorts low = hn::Min(v[0][m], hn::Min(v[1][m], v[2][m]));
      const Shorts high = hn::Max(v[0][m], hn::Max(v[1][m], v[2][m]));
      first[m] = hn::ShiftRight<kSubvoxelBits>(hn::Add(low, FillShort(kHalf - 1)));
      more[m] = hn::Sub(hn::ShiftRight<kSubvoxelBits>(hn::Add(high, FillShort(kHalf))), first[m]);
    }
  }
};

HWY_INLINE void AppendCells(const Shorts3& cells, ShortMask which, CellList& out) {
  const SelectedShorts<ShortLanes> some(ShortLanes(), which);
  for (size_t m = 0; m < 3; ++m) some.Store(cells[m], out.at[m] + out.size);
  out.size += some.count();
}

HWY_INLINE Shorts3 Plus(const Shorts3& a, const Shorts3& b) {
  return {hn::Add(a[0], b[0]), hn::Add(a[1], b[1]), hn::Add(a[2], b[2])};
}

// Numbers of 32 bits in the order that interleaving gives, lower and upper lanes.
struct Wide {
  Ints lower, upper;

  HWY_INLINE Shorts Saturated() const { return hn::ReorderDemote2To(ShortLanes(), lower, upper); }
};

HWY_INLINE Wide operator+(const Wide& a, const Wide& b) {
  return {hn::Add(a.lower, b.lower), hn::Add(a.upper, b.upper)};
}
HWY_INLINE Wide operator-(const Wide& a, const Wide& b) {
  return {hn::Sub(a.lower, b.lower), hn::Sub(a.upper, b.upper)};
}
HWY_INLINE Wide operator*(const Wide& a, const Wide& b) {
  return {hn::Mul(a.lower, b.lower), hn::Mul(a.upper, b.upper)};
}

// Pairs of lanes, for sums of two products each.
struct Pairs {
  Shorts lower, upper;

  HWY_INLINE Pairs(Shorts a, Shorts b)
      : lower(hn::InterleaveLower(ShortLanes(), a, b)), upper(hn::InterleaveUpper(ShortLanes(), a, b)) {}

  HWY_INLINE Wide Dot(const Pairs& other) const {
    const auto sum = [](Shorts a, Shorts b) HWY_ATTR {
      Ints rest = hn::Zero(Lanes());
      const Ints some = hn::ReorderWidenMulAccumulate(Lanes(), a, b, hn::Zero(Lanes()), rest);
      return hn::RearrangeToOddPlusEven(some, rest);
    };
    return {sum(lower, other.lower), sum(upper, other.upper)};
  }
};

HWY_INLINE Wide Widened(Shorts v) {
  const Pairs high(hn::Zero(ShortLanes()), v);
  return {hn::ShiftRight<16>(hn::BitCast(Lanes(), high.lower)), hn::ShiftRight<16>(hn::BitCast(Lanes(), high.upper))};
}

// The octants that some axes separate from the triangles. Lanes that are all bits say yes.
class Separated {
 public:
  Shorts octants;

  HWY_INLINE Separated() : octants(hn::Zero(ShortLanes())) {}

  // Adds the octants that vectors n separate.
  //   low, high   the least and the largest n.v of the corners
  //   sides       of the components of n that may differ from 0
  template <size_t kAxes>
  HWY_INLINE void Add(Shorts low, Shorts high, const std::array<Shorts, kAxes>& sides) {
    const Shorts above = Negative(hn::SaturatedSub(hn::Zero(ShortLanes()), low));  // 0 < low
    Shorts octant = hn::Or(above, Negative(high));
    for (const Shorts side : sides) octant = hn::And(octant, hn::Xor(side, above));
    octants = hn::Or(octants, octant);
  }
};

// The octants on the side of an axis to which a vector's component points. Their upper bits mean nothing.
HWY_INLINE Shorts SideOf(size_t axis, Shorts component) {
  return hn::Xor(Negative(component), FillShort(kHighSide[axis]));
}

// Returns the octants that the triangles meet.
//   v   corners from P
HWY_INLINE Shorts OctantsOf(const ShortCorners<ShortLanes>& v) {
  Separated separated;
  Wide at{hn::Zero(Lanes()), hn::Zero(Lanes())};  // N.v
  Shorts3 normal_sides;
  for (size_t m = 0; m < 3; ++m) {
    const size_t a = (m + 1) % 3, b = (m + 2) % 3;
    const auto edge = [&](const Shorts3& from, const Shorts3& to)
                          HWY_ATTR { return Pairs(from[a], from[b]).Dot(Pairs(to[b], hn::Neg(to[a]))); };
    const std::array<Wide, 3> e{edge(v[0], v[1]), edge(v[1], v[2]), edge(v[2], v[0])};
    const Wide area = e[0] + e[1] + e[2];
    for (size_t n = 0; n < 3; ++n) {
      const Shorts3 &from = v[n], &to = v[(n + 1) % 3];
      const Shorts at_edge = e[n].Saturated(), at_third = (e[n] - area).Saturated();
      separated.Add<2>(hn::Min(at_edge, at_third), hn::Max(at_edge, at_third),
                       {SideOf(a, hn::Sub(to[b], from[b])), SideOf(b, hn::Sub(from[a], to[a]))});
    }
    normal_sides[m] = SideOf(m, area.Saturated());
    at = at + area * Widened(v[0][m]);
  }
  const Shorts plane = at.Saturated();
  separated.Add<3>(plane, plane, normal_sides);
  return hn::AndNot(separated.octants, FillShort(kAllOctants));
}

// Appends the cells that the triangles at some places meet.
void DecideOctants(const CornerList& triangles, const uint16_t* places, size_t count, CellList& cells) {
  const ShortLanes d;
  const Shorts lane = hn::Iota(d, 0);
  for (size_t n = 0; n < count; n += kCoverLanes) {
    Shorts3 voxel;
    ShortCorners<ShortLanes> v = LoadCornersAt(d, triangles, places + n, voxel);
    const CellBoxes boxes(v);
    for (size_t m = 0; m < 3; ++m) {
      const Shorts border = hn::Add(hn::ShiftLeft<kSubvoxelBits>(boxes.first[m]), FillShort(kLatticeUnit / 2));
      for (Shorts3& corner : v) corner[m] = hn::Sub(corner[m], border);
    }
    Shorts octants = OctantsOf(v);
    for (size_t m = 0; m < 3; ++m) {  // 0 - 1 cells more: all bits if the box has none on the high side
      octants = hn::AndNot(hn::And(hn::Sub(boxes.more[m], FillShort(1)), FillShort(kHighSide[m])), octants);
    }
    const ShortMask given = hn::Lt(lane, FillShort(static_cast<int>(std::min(count - n, kCoverLanes))));
    octants = hn::IfThenElseZero(given, octants);
    const Shorts3 low = Plus(voxel, boxes.first), high = Plus(low, {FillShort(1), FillShort(1), FillShort(1)});
    for (size_t octant = 0; octant < kOctants; ++octant) {
      AppendCells({octant & 1 ? high[0] : low[0], octant & 2 ? high[1] : low[1], octant & 4 ? high[2] : low[2]},
                  hn::TestBit(octants, FillShort(1 << octant)), cells);
    }
  }
}

void FindCells(const CornerList& triangles, CellList& cells, std::vector<uint32_t>& kept) {
  const ShortLanes d;
  cells.size = 1;
  uint16_t open[CornerList::kMost + CornerList::kSlack];  // places of triangles with several cells along several axes
  size_t open_size = 0;
  const Shorts place_of = StoredOrder(d);  // counted from the first one
  const LaneOrder in_order(d, place_of);
  for (size_t n = 0; n < triangles.size; n += kCoverLanes) {
    Shorts3 voxel;
    const ShortCorners<ShortLanes> v = LoadStored(d, triangles, n, voxel);
    const CellBoxes boxes(v);
    const ShortMask given = hn::Lt(place_of, FillShort(static_cast<int>(std::min(triangles.size - n, kCoverLanes))));
    const Shorts more = hn::Add(hn::Add(boxes.more[0], boxes.more[1]), boxes.more[2]);
    const Shorts most = hn::Max(hn::Max(boxes.more[0], boxes.more[1]), boxes.more[2]);
    const ShortMask tiny = hn::And(given, hn::And(AreNear(d, v), hn::Lt(most, FillShort(kMostCells))));
    const ShortMask in_row = hn::And(tiny, hn::Lt(more, FillShort(2)));
    const Shorts3 cell = Plus(voxel, boxes.first);
    AppendCells(cell, in_row, cells);
    AppendCells(Plus(cell, boxes.more), hn::And(tiny, hn::Eq(more, FillShort(1))), cells);
    const SelectedShorts<ShortLanes> others(d, hn::AndNot(in_row, tiny));
    others.Store(hn::Add(place_of, FillShort(static_cast<int>(n))), open + open_size);
    open_size += others.count();
    const ShortMask keep = hn::AndNot(tiny, given);
    if (hn::AllFalse(d, keep)) continue;
    for (uint64_t bits = in_order(keep); bits != 0; bits &= bits - 1) {
      kept.push_back(triangles.triangles[n + static_cast<size_t>(std::countr_zero(bits))]);
    }
  }
  std::fill_n(open + open_size, kCoverLanes, 0);
  DecideOctants(triangles, open, open_size, cells);
}

// Leaves out cells that repeat the one before, as neighbors among tiny triangles often do.
//   wanted   counted from the first tile's voxel
void PackCells(const CellList& cells, const IndexBox& wanted, PackedLinks& out) {
  const Lanes d;
  const hn::Rebind<int16_t, Lanes> narrow;
  out.Reserve(cells.size);
  for (size_t n = 1; n < cells.size; n += kTriangleLanes) {
    auto inside = hn::FirstN(d, cells.size - n);
    Ints tile = hn::Zero(d), link = tile, change = tile;
    for (size_t m = 0; m < 3; ++m) {
      const auto load = [&](size_t from) HWY_ATTR {
        return hn::PromoteTo(d, hn::LoadU(narrow, reinterpret_cast<const int16_t*>(cells.at[m] + from)));
      };
      const Ints cell = load(n), at = hn::Sub(cell, Fill(CornerList::kFirstVoxel));
      change = hn::Or(change, hn::Xor(cell, load(n - 1)));
      inside = hn::And(inside, hn::And(hn::Gt(at, Fill(wanted.min[m] - 1)), hn::Lt(at, Fill(wanted.max[m]))));
      tile = hn::Or(hn::ShiftLeft<kPackedTileBits>(tile), hn::ShiftRight<kTileBits>(at));
      link = hn::Or(hn::ShiftLeft<kTileBits>(link), hn::And(at, Fill(kTileSide - 1)));
    }
    const SelectedLanes<Lanes> selected(d, hn::And(inside, hn::Ne(change, hn::Zero(d))));
    selected.Store(tile, out.tiles.end());
    selected.Store(hn::ShiftLeft<kPackedEndShift>(link), out.links.end());
    out.Grow(selected.count());
  }
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace latvox {
namespace {

HWY_EXPORT(FindCells);
HWY_EXPORT(PackCells);

}  // namespace

struct TinyCover::State {
  IndexBox wanted;  // counted from the first tile's voxel
  TileLinks& links;
  std::unique_ptr<TileLinks::Part> part;
  CellList cells = {};
  PackedLinks found = {};
};

TinyCover::TinyCover(const IndexBox& box, TileLinks& links) : state_(new State{{}, links, links.ReservePart()}) {
  const Vec3i first = links.first_tile() * kTileSide;
  for (size_t m = 0; m < 3; ++m) {
    state_->wanted.min[m] = std::max(box.min[m] - first[m], 0);
    state_->wanted.max[m] = std::min(box.max[m] - first[m], kTileSide << kPackedTileBits);
  }
}

TinyCover::~TinyCover() { state_->links.ReleasePart(std::move(state_->part)); }

void TinyCover::Find(const CornerList& triangles, std::vector<uint32_t>& kept) {
  auto& [wanted, links, part, cells, found] = *state_;
  HWY_DYNAMIC_DISPATCH(FindCells)(triangles, cells, kept);
  HWY_DYNAMIC_DISPATCH(PackCells)(cells, wanted, found);
  part->Move(found, links.margin());
}

}  // namespace latvox
#endif  // HWY_ONCE
