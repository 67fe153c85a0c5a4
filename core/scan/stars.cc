// Pairs of voxel and triangle in lanes, direction after direction. The products are those of core/digitize/star.h:
// first in floats with bounded errors, then exactly where the floats leave a sign open (a floating-point filter).
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/scan/stars.cc"
#include "core/scan/stars.h"

#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/digitize/star.h"
#include "core/scan/scaled_triangles-inl.h"
#include "core/triangles/padded_vertices.h"
#include "core/triangles/positions-inl.h"
#include "core/triangles/triangle_lanes-inl.h"

namespace latvox {
#ifndef LATVOX_CORE_DIGITIZE_STARS_CC_ONCE
#define LATVOX_CORE_DIGITIZE_STARS_CC_ONCE
namespace {

// The largest distance of a triangle's corners from the voxel, per axis in lattice units. Within it, floats hold the
// coordinates, and doubles all products except that of normal and offset (see Distance). With offsets of b bits, sides
// have b + 1 bits, normals 2 * b + 2 (twice an area within a square of sides), moments 2 * b + 1, and their products
// with q 3 more.
constexpr int kOffsetBits = 24;
static_assert(kMaxDirection <= 8 && 2 * kOffsetBits + 2 + 3 <= 53);

StarLinks ScalarStarLinks(const Triangle& triangle, const std::vector<ScanFrame>& frames, const Vec3i& z) {
  StarLinks edges{};
  const OrientedTriangle oriented(triangle);
  const Star star(oriented, z);
  for (size_t n = 0; n < frames.size(); ++n) {
    const Vec3i& q = frames[n].frame.q;
    Vec3i step;
    if (!star.IsNearerEnd(q, step)) continue;
    edges.nearer |= 1U << n;
    if (step == q) edges.forward |= 1U << n;
  }
  return edges;
}

Triangle TriangleOf(const SnappedMesh& mesh, uint32_t index) {
  const auto& [v0, v1, v2] = mesh.triangles[index];
  return {mesh.vertices_lat[v0], mesh.vertices_lat[v1], mesh.vertices_lat[v2]};
}

void FindScalar(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const BitsLayout& layout,
                std::span<const VoxelTriangle> pairs, StarLinks* out) {
  for (const auto& [voxel, triangle] : pairs) {
    *out++ = ScalarStarLinks(TriangleOf(mesh, triangle), frames, layout.VoxelAt(voxel));
  }
}

}  // namespace
#endif
}  // namespace latvox

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR
void FindInLanes(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const BitsLayout& layout,
                 std::span<const VoxelTriangle> pairs, StarLinks* out) {
  FindScalar(mesh, frames, layout, pairs, out);
}
#else

namespace hn = hwy::HWY_NAMESPACE;

// Finds the certain links of pairs in lanes. Returns the lanes in which the rounding of floats leaves some links open;
// bit n for lane n.
//   corners    of the triangles, from the voxels, by axis in lattice units
//   farthest   each lane's largest |coordinate|; beyond 2^kOffsetBits, a lane's result is meaningless
//   reach      the largest |entry| of directions
// Bounds of errors: see core/scan/scaled_triangles-inl.h, with w for `farthest` and r for `reach`.
HWY_INLINE uint64_t SureStars(const std::vector<ScanFrame>& frames, int32_t reach, const std::array<Ints3, 3>& corners,
                              Ints farthest, StarLinks* out) {
  const Float d;
  const Lanes ints;
  std::array<Floats3, 3> v;
  for (size_t n = 0; n < 3; ++n) {
    for (size_t m = 0; m < 3; ++m) v[n][m] = hn::ConvertTo(d, corners[n][m]);
  }
  const auto [normal, moment] = ScaledTriangles(v);
  const Floats minus_distance = DotOf(normal, v[0]);
  const auto below = hn::Gt(minus_distance, hn::Zero(d));

  constexpr float kHalfStep = kLatticeUnit / 2;
  const auto scaled = [&](float by, Floats x) HWY_ATTR { return hn::Mul(hn::Set(d, by), x); };
  const auto r = static_cast<float>(reach);
  const Floats w = hn::ConvertTo(d, farthest), distance_error = scaled(kNormalError, w);
  const Floats side_error = scaled(kMomentError * r, w), minus_side_error = hn::Neg(side_error);
  // In half steps, a power of two of lattice units.
  const Floats away = scaled(1 / kHalfStep, hn::Abs(minus_distance)),
               away_error = scaled(1 / kHalfStep, distance_error);
  const Floats plane_error = hn::Add(away_error, hn::Set(d, kNormalError * r)),
               minus_plane_error = hn::Neg(plane_error);

  using Dots = Multiples<Float>;
  const Dots by_normal(d, normal, reach);
  const Dots by_moment[3] = {{d, moment[0], reach}, {d, moment[1], reach}, {d, moment[2], reach}};
  Ints nearer = hn::Zero(ints), forward = nearer;
  auto open = hn::FirstN(d, 0);
  for (size_t n = 0; n < frames.size(); ++n) {
    const Vec3i& q = frames[n].frame.q;
    const Floats along = by_normal.Dot(q);
    // The amount by which the plane is nearer than half a step.
    const Floats nearer_by = hn::Sub(hn::Abs(along), away);
    const auto may_be_near = hn::Not(hn::Lt(nearer_by, minus_plane_error));
    if (hn::AllFalse(d, may_be_near)) continue;
    const Floats s0 = by_moment[0].Dot(q), s1 = by_moment[1].Dot(q), s2 = by_moment[2].Dot(q);
    const Floats least = hn::Min(s0, hn::Min(s1, s2)), most = hn::Max(s0, hn::Max(s1, s2));
    // Unscaled, sides add up to `along`: with one sign, they have its sign, too.
    const auto up = hn::Gt(least, side_error), inside = hn::Or(up, hn::Lt(most, minus_side_error));
    const auto outside = hn::And(hn::Lt(least, minus_side_error), hn::Gt(most, side_error));
    const auto meets = hn::And(hn::Gt(nearer_by, plane_error), inside);
    open = hn::Or(open, hn::AndNot(hn::Or(meets, outside), may_be_near));
    const Ints bit = Fill(1 << n);
    const auto leads_forward = hn::AndNot(hn::Xor(up, below), meets);
    nearer = hn::Or(nearer, hn::IfThenElseZero(hn::RebindMask(ints, meets), bit));
    forward = hn::Or(forward, hn::IfThenElseZero(hn::RebindMask(ints, leads_forward), bit));
  }
  // The side of the plane on which the voxel lies gives the direction to the farther end.
  const auto sided = hn::RebindMask(ints, hn::Gt(away, away_error));
  int32_t bits[2][kTriangleLanes];
  hn::StoreU(nearer, ints, bits[0]);
  hn::StoreU(forward, ints, bits[1]);
  for (size_t n = 0; n < kTriangleLanes; ++n) {
    out[n] = {static_cast<uint32_t>(bits[0][n]), static_cast<uint32_t>(bits[1][n])};
  }
  return BitsOf(hn::Or(hn::RebindMask(ints, open), hn::AndNot(sided, hn::Ne(nearer, hn::Zero(ints)))));
}

using Double = hn::ScalableTag<double>;
using Doubles = hn::Vec<Double>;
using Doubles3 = std::array<Doubles, 3>;
constexpr size_t kDoubles = HWY_LANES(double);

// Returns ceil(n . w / 128), where the unit of n . q is 256. Then -along < result <= along means that the voxel is the
// nearer end. Terms may take more than 64 bits, but their sum does not where the voxel is as close to the plane as
// candidates are. Elsewhere the doubles show it, and the result is infinity.
HWY_INLINE Doubles Distance(const Doubles3& n, const Doubles3& w) {
  const Double d;
  alignas(64) double normal[3][kDoubles], offset[3][kDoubles], distance[kDoubles];
  for (size_t m = 0; m < 3; ++m) {
    hn::Store(n[m], d, normal[m]);
    hn::Store(w[m], d, offset[m]);
  }
  for (size_t lane = 0; lane < kDoubles; ++lane) {
    uint64_t sum = 0;  // modulo 2^64
    double estimate = 0;
    for (size_t m = 0; m < 3; ++m) {
      sum += static_cast<uint64_t>(static_cast<int64_t>(normal[m][lane])) *
             static_cast<uint64_t>(static_cast<int64_t>(offset[m][lane]));
      estimate += normal[m][lane] * offset[m][lane];
    }
    const bool far = std::abs(estimate) > 0x1p62;
    distance[lane] =
        far ? std::numeric_limits<double>::infinity() : static_cast<double>((static_cast<int64_t>(sum) + 127) >> 7);
  }
  return hn::Load(d, distance);
}

// Finds the links of pairs in lanes, exactly; v: the corners, as in SureStars.
HWY_INLINE void ExactStars(const std::vector<ScanFrame>& frames, int32_t reach, const std::array<Doubles3, 3>& v,
                           StarLinks* out) {
  const Double d;
  using V = Doubles;
  using V3 = Doubles3;
  const V zero = hn::Zero(d);
  const auto times = [&](int32_t c, V x) {
    return c == 0 ? zero : c == 1 ? x : c == -1 ? hn::Neg(x) : hn::Mul(hn::Set(d, static_cast<double>(c)), x);
  };

  V3 normal = CrossOf(Minus(v[1], v[0]), Minus(v[2], v[0]));
  // Turned so that the normal's first nonzero entry is positive, which reverses all products.
  const auto reversed = hn::Lt(FirstNonzero(normal), zero);
  const auto turn = [&](V3& a) {
    for (V& x : a) x = hn::IfThenElse(reversed, hn::Neg(x), x);
  };
  // (B - A) x (z - A) = A x B for z at the origin.
  std::array<V3, 3> moment;
  for (size_t n = 0; n < 3; ++n) {
    moment[n] = CrossOf(v[n], v[(n + 1) % 3]);
    turn(moment[n]);
  }
  turn(normal);
  const V distance = Distance(normal, {hn::Neg(v[0][0]), hn::Neg(v[0][1]), hn::Neg(v[0][2])});
  const auto below = hn::Not(hn::Gt(distance, zero));

  // Returns whether the shift moves the line through the voxel along u to the inner side of the triangle's edge n, that
  // is, whether s . (edge x u) > 0. Here u is q if `up`, else -q.
  const auto tie_is_inside = [&](size_t n, const Vec3i& q, hn::Mask<decltype(d)> up) HWY_ATTR {
    V3 edge = Minus(v[(n + 1) % 3], v[n]);
    turn(edge);
    const V3 by{hn::Sub(times(q[2], edge[1]), times(q[1], edge[2])),
                hn::Sub(times(q[0], edge[2]), times(q[2], edge[0])),
                hn::Sub(times(q[1], edge[0]), times(q[0], edge[1]))};
    const V first_by = FirstNonzero(by);
    return hn::Gt(hn::IfThenElse(up, first_by, hn::Neg(first_by)), zero);
  };
  using Dots = Multiples<decltype(d)>;
  const Dots by_normal(d, normal, reach);
  const Dots by_moment[3] = {{d, moment[0], reach}, {d, moment[1], reach}, {d, moment[2], reach}};
  V nearer = zero, forward = zero;
  for (size_t n = 0; n < frames.size(); ++n) {
    const Vec3i& q = frames[n].frame.q;
    const V along = by_normal.Dot(q), size = hn::Abs(along);
    auto meets = hn::And(hn::Lt(hn::Neg(size), distance), hn::Not(hn::Gt(distance, size)));
    if (hn::AllFalse(d, meets)) continue;
    const auto up = hn::Gt(along, zero);
    const V s0 = by_moment[0].Dot(q), s1 = by_moment[1].Dot(q), s2 = by_moment[2].Dot(q);
    const V least = hn::Min(s0, hn::Min(s1, s2)), most = hn::Max(s0, hn::Max(s1, s2));
    // All on the inner side: not negative, or not positive where u = -q.
    const V outermost = hn::IfThenElse(up, least, hn::Neg(most));
    meets = hn::And(meets, hn::Not(hn::Lt(outermost, zero)));
    if (!hn::AllFalse(d, hn::And(meets, hn::Eq(outermost, zero)))) {
      const V sides[3] = {s0, s1, s2};
      for (size_t m = 0; m < 3; ++m) {
        meets = hn::And(meets, hn::Or(hn::Ne(sides[m], zero), tie_is_inside(m, q, up)));
      }
    }
    const V bit = hn::Set(d, static_cast<double>(1 << n));
    nearer = hn::Add(nearer, hn::IfThenElseZero(meets, bit));
    forward = hn::Add(forward, hn::IfThenElseZero(hn::And(meets, hn::Not(hn::Xor(up, below))), bit));
  }
  alignas(64) double bits[2][kDoubles];
  hn::Store(nearer, d, bits[0]);
  hn::Store(forward, d, bits[1]);
  for (size_t n = 0; n < kDoubles; ++n) out[n] = {static_cast<uint32_t>(bits[0][n]), static_cast<uint32_t>(bits[1][n])};
}

// The number of pairs that are done together.
constexpr size_t kAtOnce = 64;
struct Pairs {
  alignas(64) int32_t corners[3][3][kAtOnce];  // from the voxels, by axis
  StarLinks edges[kAtOnce];
};

// Finds the links of the pairs whose bits are set.
void FindExactly(const std::vector<ScanFrame>& frames, int32_t reach, uint64_t which, Pairs& pairs) {
  const hn::Rebind<int32_t, Double> ints;
  while (which != 0) {
    alignas(64) int32_t places[kDoubles];
    size_t count = 0;
    for (; which != 0 && count < kDoubles; which &= which - 1) places[count++] = std::countr_zero(which);
    std::fill(places + count, std::end(places), places[0]);
    std::array<Doubles3, 3> v;
    for (size_t c = 0; c < 3; ++c) {
      for (size_t m = 0; m < 3; ++m) {
        v[c][m] = hn::PromoteTo(Double(), hn::GatherIndex(ints, pairs.corners[c][m], hn::Load(ints, places)));
      }
    }
    StarLinks edges[kDoubles];
    ExactStars(frames, reach, v, edges);
    for (size_t n = 0; n < count; ++n) pairs.edges[places[n]] = edges[n];
  }
}

void FindInLanes(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const BitsLayout& layout,
                 std::span<const VoxelTriangle> pairs, StarLinks* out) {
  const PaddedVertices vertices(mesh);
  int32_t reach = 0;
  for (const ScanFrame& scan : frames) {
    for (const int32_t q : scan.frame.q) reach = std::max(reach, std::abs(q));
  }
  for (; !pairs.empty(); pairs = pairs.subspan(std::min(kAtOnce, pairs.size()))) {
    const size_t count = std::min(kAtOnce, pairs.size());
    // All voxels come first, because numbers written one by one cannot be read as a vector at once.
    int32_t voxels[kAtOnce];
    for (size_t n = 0; n < count; ++n) {
      hwy::Prefetch(&mesh.triangles[pairs[n].triangle]);
      voxels[n] = static_cast<int32_t>(pairs[n].voxel);
    }
    std::array<uint32_t, 3> corners[kAtOnce];
    for (size_t n = 0; n < count; ++n) {
      corners[n] = mesh.triangles[pairs[n].triangle];
      for (const uint32_t vertex : corners[n]) hwy::Prefetch(vertices[vertex]);
    }
    std::fill(corners + count, std::end(corners), corners[0]);
    std::fill(voxels + count, std::end(voxels), voxels[0]);
    Pairs these;
    uint64_t open = 0, far = 0;
    for (size_t first = 0; first < count; first += kTriangleLanes) {
      const Lanes d;
      std::array<Ints3, 3> v =
          LoadCorners([&](size_t c, size_t n) HWY_ATTR { return vertices[corners[first + n][c]]; });
      const Ints3 z = PositionsOf(layout, hn::LoadU(d, voxels + first));
      Ints farthest = hn::Zero(d);
      for (size_t c = 0; c < 3; ++c) {
        for (size_t m = 0; m < 3; ++m) {
          v[c][m] = hn::Sub(v[c][m], z[m]);
          hn::Store(v[c][m], d, these.corners[c][m] + first);
          farthest = hn::Max(farthest, hn::Abs(v[c][m]));
        }
      }
      open |= SureStars(frames, reach, v, farthest, these.edges + first) << first;
      far |= BitsOf(hn::Gt(farthest, Fill(1 << kOffsetBits))) << first;
    }
    const uint64_t given = ~uint64_t{0} >> (kAtOnce - count);
    FindExactly(frames, reach, open & ~far & given, these);
    for (far &= given; far != 0; far &= far - 1) {
      const auto n = static_cast<size_t>(std::countr_zero(far));
      these.edges[n] = ScalarStarLinks(TriangleOf(mesh, pairs[n].triangle), frames, layout.VoxelAt(pairs[n].voxel));
    }
    out = std::copy_n(these.edges, count, out);
  }
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

HWY_EXPORT(FindInLanes);

}  // namespace

void FindStarLinks(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const BitsLayout& layout,
                   std::span<const VoxelTriangle> pairs, StarLinks* out) {
  SimdIsScalar() ? FindScalar(mesh, frames, layout, pairs, out)
                 : HWY_DYNAMIC_DISPATCH(FindInLanes)(mesh, frames, layout, pairs, out);
}

}  // namespace latvox
#endif  // HWY_ONCE
