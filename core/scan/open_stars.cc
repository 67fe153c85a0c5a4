// All links of a star lead to the same side of its triangle's plane: to neighbors z + q above it, with n . q > 0, if z
// lies on the plane or below, else to neighbors below it (core/digitize/star.h). So a star has nothing to add to a set
// that has z and all neighbors on that side. The links themselves need not be found.
//
// On a plane, this leaves out nearly every star. Let C be the principal direction, the q with the largest |n . q|. Say
// z lies below: -|n . C| / 2 < d(z) <= 0. Then a neighbor above it has -|n . C| / 2 < d(z + q) <= |n . C|. So it is an
// end of the link that the plane crosses on its line along C. Where that line meets the triangle, it comes with the
// candidates that are crossed. On a smooth surface, the line meets a neighboring triangle.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/scan/open_stars.cc"
#include "core/scan/open_stars.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <span>

#include "core/base/words_at-inl.h"
#include "core/scan/scaled_triangles-inl.h"
#include "core/triangles/padded_vertices.h"
#include "core/triangles/positions-inl.h"
#include "core/triangles/triangle_lanes-inl.h"

namespace latvox {
#ifndef LATVOX_CORE_SCAN_OPEN_STARS_CC_ONCE
#define LATVOX_CORE_SCAN_OPEN_STARS_CC_ONCE
namespace {

static_assert(std::endian::native == std::endian::little, "rows of bits are read as bytes");
static_assert(2 * kMaxDirection + 1 + 7 <= 32, "a word holds a voxel's neighbors in a row, from a whole byte on");

// A run and its parts of the candidates' lists.
struct RunOf {
  Candidates::Run run;
  uint32_t crossed_begin, rim_begin;
  std::span<const uint32_t> triangles;

  RunOf(const Candidates& candidates, size_t n) : run(candidates.runs[n]) {
    crossed_begin = n == 0 ? 0 : candidates.runs[n - 1].crossed_end;
    rim_begin = n == 0 ? 0 : candidates.runs[n - 1].rim_end;
    const size_t end = n + 1 < candidates.runs.size() ? candidates.runs[n + 1].first : candidates.triangles.size();
    triangles = std::span(candidates.triangles).subspan(run.first, end - run.first);
  }

  VoxelTriangle PairOf(uint32_t candidate) const {
    return {candidate & kNumberMask, triangles[candidate >> kNumberBits]};
  }
};

void AppendAll(const Candidates& candidates, const RunOf& these, std::vector<VoxelTriangle>& pairs) {
  for (uint32_t n = these.crossed_begin; n < these.run.crossed_end; ++n) {
    pairs.push_back(these.PairOf(candidates.nearer[n]));
  }
  for (uint32_t n = these.rim_begin; n < these.run.rim_end; ++n) pairs.push_back(these.PairOf(candidates.rim[n]));
}

}  // namespace
#endif
}  // namespace latvox

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR
void AppendInLanes(const SnappedMesh&, const std::vector<ScanFrame>&, const BitsLayout&, const NeighborRows&,
                   const TileBits&, const Candidates& candidates, const RunOf& these,
                   std::vector<VoxelTriangle>& pairs) {
  AppendAll(candidates, these, pairs);
}
#else

namespace hn = hwy::HWY_NAMESPACE;

// The planes of up to kTriangleLanes triangles, and the neighbors on their sides. Where floats do not decide, normal
// and step are 0, which leaves all stars of the triangle open.
struct RunPlanes {
  // Within it, floats hold the corners, seen from the layout's origin or from a voxel.
  static constexpr int32_t kFarthest = 1 << 23;

  Floats3 normal;
  Ints3 corner;                                                 // the first one, lattice units from the layout's origin
  Ints step;                                                    // of a voxel's number, up the principal direction
  Ints above[NeighborRows::kMost], below[NeighborRows::kMost];  // bits of rows; those that may be either are in both

  HWY_INLINE RunPlanes(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const BitsLayout& layout,
                       const NeighborRows& rows, std::span<const uint32_t> triangles) {
    const Float d;
    const std::array<Ints3, 3> v =
        LoadCorners(mesh, PaddedVertices(mesh), LaneNumbers(triangles), layout.origin * kLatticeUnit);
    Ints farthest = hn::Zero(Lanes());
    std::array<Floats3, 3> corners;
    for (size_t c = 0; c < 3; ++c) {
      for (size_t m = 0; m < 3; ++m) {
        farthest = hn::Max(farthest, hn::Abs(v[c][m]));
        corners[c][m] = hn::ConvertTo(d, v[c][m]);
      }
    }
    corner = v[0];
    normal = ScaledTriangles(corners).normal;
    const Floats error = hn::Set(d, kNormalError * static_cast<float>(rows.reach));
    const Floats length = FindSides(frames, layout, rows, error);
    const auto sure = hn::And(hn::RebindMask(d, hn::Lt(farthest, Fill(kFarthest))), hn::Gt(length, error));
    for (Floats& entry : normal) entry = hn::IfThenElseZero(sure, entry);
    step = hn::IfThenElseZero(hn::RebindMask(Lanes(), sure), step);
  }

 private:
  // Returns the largest |n . q|.
  HWY_INLINE Floats FindSides(const std::vector<ScanFrame>& frames, const BitsLayout& layout, const NeighborRows& rows,
                              Floats error) {
    const Float d;
    const Lanes ints;
    const Floats minus_error = hn::Neg(error);
    const Multiples<Float> by_normal(d, normal, rows.reach);
    for (size_t row = 0; row < rows.count; ++row) above[row] = below[row] = hn::Zero(ints);
    above[rows.itself.row] = below[rows.itself.row] = Fill(int64_t{1} << rows.itself.bit);
    Floats most = hn::Zero(d);
    step = hn::Zero(ints);
    for (size_t n = 0; n < frames.size(); ++n) {
      const Floats along = by_normal.Dot(frames[n].frame.q), size = hn::Abs(along);
      const auto up = hn::RebindMask(ints, hn::Gt(along, minus_error)),
                 down = hn::RebindMask(ints, hn::Lt(along, error));
      const auto add = [&](Ints* side, const NeighborRows::Place& at, hn::Mask<Lanes> mask) HWY_ATTR {
        side[at.row] = hn::Or(side[at.row], hn::IfThenElseZero(mask, Fill(int64_t{1} << at.bit)));
      };
      add(above, rows.forward[n], up);
      add(above, rows.backward[n], down);
      add(below, rows.forward[n], down);
      add(below, rows.backward[n], up);
      const Ints by = Fill(layout.StepOf(frames[n].frame.q));
      const auto more = hn::RebindMask(ints, hn::Gt(size, hn::Add(most, error))),  // of equal ones the first
          points_up = hn::RebindMask(ints, hn::Gt(along, hn::Zero(d)));
      step = hn::IfThenElse(more, hn::IfThenElse(points_up, by, hn::Neg(by)), step);
      most = hn::Max(most, size);
    }
    return most;
  }
};

// The places of candidates' triangles in their run.
HWY_INLINE auto PlacesOf(Ints candidates) {
  const hn::RebindToUnsigned<Lanes> du;
  return hn::IndicesFromVec(Lanes(), hn::BitCast(Lanes(), hn::ShiftRight<kNumberBits>(hn::BitCast(du, candidates))));
}

// The sides of their triangles' planes on which candidates lie.
struct Sides {
  hn::Mask<Lanes> is_below, is_above;
};

// The stars of a run that are open.
class OpenStars {
 public:
  HWY_INLINE OpenStars(const BitsLayout& layout, const NeighborRows& rows, const TileBits& set, const RunPlanes& planes,
                       const RunOf& these, std::vector<VoxelTriangle>& pairs)
      : layout_(layout),
        rows_(rows),
        bytes_(reinterpret_cast<const char*>(set.words().data())),
        planes_(planes),
        these_(these),
        pairs_(pairs) {}

  // Where a triangle crosses a line, the farther end tells the side.
  HWY_INLINE void AddCrossed(const uint32_t* nearer, const uint32_t* farther, size_t size) const {
    const Lanes d;
    for (size_t n = 0; n < size; n += kTriangleLanes) {
      const Ints candidate = Load(nearer, n, size);
      const Ints to_farther = hn::Sub(hn::LoadU(d, reinterpret_cast<const int32_t*>(farther + n)), candidate);
      const Ints up = hn::TableLookupLanes(planes_.step, PlacesOf(candidate));
      AppendOpen(nearer + n, size - n, candidate, {hn::Eq(to_farther, up), hn::Eq(to_farther, hn::Neg(up))});
    }
  }

  HWY_INLINE void AddRim(const uint32_t* rim, size_t size) const {
    for (size_t n = 0; n < size; n += kTriangleLanes) {
      const Ints candidate = Load(rim, n, size);
      AppendOpen(rim + n, size - n, candidate, SidesOf(candidate));
    }
  }

 private:
  // Lanes without a candidate repeat the first one.
  static HWY_INLINE Ints Load(const uint32_t* candidates, size_t n, size_t size) {
    const Lanes d;
    const auto given = hn::FirstN(d, size - n);
    return hn::IfThenElse(given, hn::LoadU(d, reinterpret_cast<const int32_t*>(candidates + n)), Fill(candidates[0]));
  }

  HWY_INLINE Sides SidesOf(Ints candidate) const {
    const Float d;
    const auto place = PlacesOf(candidate);
    const Ints3 z =
        Minus(PositionsOf(layout_, hn::And(candidate, Fill(kNumberMask))), Fill3(layout_.origin * kLatticeUnit));
    Floats3 normal, to_corner;
    Floats farthest = hn::Zero(d);
    for (size_t m = 0; m < 3; ++m) {
      normal[m] = hn::BitCast(d, hn::TableLookupLanes(hn::BitCast(Lanes(), planes_.normal[m]), place));
      to_corner[m] = hn::ConvertTo(d, hn::Sub(hn::TableLookupLanes(planes_.corner[m], place), z[m]));
      farthest = hn::Max(farthest, hn::Abs(to_corner[m]));
    }
    const Floats above_z = DotOf(normal, to_corner), error = hn::Mul(hn::Set(d, kNormalError), farthest);
    return {hn::RebindMask(Lanes(), hn::Gt(above_z, error)), hn::RebindMask(Lanes(), hn::Lt(above_z, hn::Neg(error)))};
  }

  HWY_INLINE void AppendOpen(const uint32_t* candidates, size_t size, Ints candidate, const Sides& sides) const {
    const Lanes d;
    const hn::RebindToUnsigned<Lanes> du;
    const auto place = PlacesOf(candidate);
    const auto first = hn::Sub(hn::BitCast(du, hn::And(candidate, Fill(kNumberMask))),
                               hn::Set(du, static_cast<uint32_t>(rows_.reach_in_row)));
    // From the lowest row, so that no pointer leaves the set.
    const auto byte = hn::Add(hn::ShiftRight<3>(first), hn::BitCast(du, Fill(rows_.least_step)));
    const auto bit = hn::And(first, hn::Set(du, 7));
    auto missing = hn::Zero(du);
    for (size_t row = 0; row < rows_.count; ++row) {
      const Ints wanted = hn::IfThenElse(sides.is_below, hn::TableLookupLanes(planes_.above[row], place),
                                         hn::TableLookupLanes(planes_.below[row], place));
      const auto found = hn::Shr(WordsAt<1>(bytes_ + (rows_.byte_steps[row] - rows_.least_step), byte), bit);
      missing = hn::Or(missing, hn::AndNot(found, hn::BitCast(du, wanted)));
    }
    const auto complete = hn::And(hn::Or(sides.is_below, sides.is_above), hn::Eq(hn::BitCast(d, missing), hn::Zero(d)));
    const auto open = hn::AndNot(complete, hn::FirstN(d, size));
    for (uint64_t which = BitsOf(open); which != 0; which &= which - 1) {
      pairs_.push_back(these_.PairOf(candidates[std::countr_zero(which)]));
    }
  }

  const BitsLayout& layout_;
  const NeighborRows& rows_;
  const char* bytes_;
  const RunPlanes& planes_;
  const RunOf& these_;
  std::vector<VoxelTriangle>& pairs_;
};

void AppendInLanes(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const BitsLayout& layout,
                   const NeighborRows& rows, const TileBits& set, const Candidates& candidates, const RunOf& these,
                   std::vector<VoxelTriangle>& pairs) {
  const uint32_t crossed = these.crossed_begin, rim = these.rim_begin;
  if (these.run.crossed_end == crossed && these.run.rim_end == rim) return;
  const RunPlanes planes(mesh, frames, layout, rows, these.triangles);
  const OpenStars stars(layout, rows, set, planes, these, pairs);
  stars.AddCrossed(candidates.nearer.view().data() + crossed, candidates.farther.view().data() + crossed,
                   these.run.crossed_end - crossed);
  stars.AddRim(candidates.rim.view().data() + rim, these.run.rim_end - rim);
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "core/base/simd.h"

namespace latvox {
namespace {

HWY_EXPORT(AppendInLanes);

}  // namespace

NeighborRows::NeighborRows(const std::vector<ScanFrame>& frames, const BitsLayout& layout) {
  for (const ScanFrame& scan : frames) {
    for (const int32_t q : scan.frame.q) reach = std::max(reach, std::abs(q));
    reach_in_row = std::max(reach_in_row, std::abs(scan.frame.q[2]));
  }
  itself = Add(layout, {});
  for (size_t n = 0; n < frames.size(); ++n) {
    forward[n] = Add(layout, frames[n].frame.q);
    backward[n] = Add(layout, -frames[n].frame.q);
  }
}

// Rows begin at whole bytes.
NeighborRows::Place NeighborRows::Add(const BitsLayout& layout, const Vec3i& step) {
  const int32_t bytes = layout.StepOf({step[0], step[1], 0}) / 8;
  const auto row =
      static_cast<size_t>(std::find(byte_steps.begin(), byte_steps.begin() + count, bytes) - byte_steps.begin());
  byte_steps[row] = bytes;
  least_step = std::min(least_step, bytes);
  count = std::max(count, row + 1);
  return {row, static_cast<uint32_t>(step[2] + reach_in_row)};
}

void AppendOpenStars(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const BitsLayout& layout,
                     const NeighborRows& rows, const TileBits& set, const Candidates& candidates, size_t run,
                     std::vector<VoxelTriangle>& pairs) {
  const RunOf these(candidates, run);
  if (SimdIsScalar()) return AppendAll(candidates, these, pairs);
  HWY_DYNAMIC_DISPATCH(AppendInLanes)(mesh, frames, layout, rows, set, candidates, these, pairs);
}

}  // namespace latvox
#endif  // HWY_ONCE
