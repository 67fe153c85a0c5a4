// Voxel-triangle pairs in the lanes; direction after direction. The products are those of core/digitize/star.h.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/digitize/stars.cc"
#include "core/digitize/stars.h"

#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/digitize/star.h"
#include "core/snap/padded_vertices.h"
#include "core/snap/triangle_lanes-inl.h"

namespace latvox {
#ifndef LATVOX_CORE_DIGITIZE_STARS_CC_ONCE
#define LATVOX_CORE_DIGITIZE_STARS_CC_ONCE
namespace {

// How far a triangle's corners may be from the voxel, per axis in lattice units, so that T holds all products. With
// offsets of b bits, sides have b + 1 bits, normals 2 * b + 2 (twice an area within a square of sides), moments
// 2 * b + 1, and these with q 3 more.
template <class T>
inline constexpr int kOffsetBits = sizeof(T) == 4 ? 12 : 24;
static_assert(kMaxDirection <= 8 && 2 * kOffsetBits<int32_t> + 2 + 3 <= 30 && 2 * kOffsetBits<double> + 2 + 3 <= 53);
static_assert(3 * kOffsetBits<int32_t> + 2 - 7 <= 31);

StarEdges ScalarStarEdges(const Triangle& triangle, const std::vector<ScanFrame>& frames, const Vec3i& z) {
  StarEdges edges{};
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
                std::span<const VoxelTriangle> pairs, StarEdges* out) {
  for (const auto& [voxel, triangle] : pairs) {
    *out++ = ScalarStarEdges(TriangleOf(mesh, triangle), frames, layout.VoxelAt(voxel));
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
                 std::span<const VoxelTriangle> pairs, StarEdges* out) {
  FindScalar(mesh, frames, layout, pairs, out);
}
#else

namespace hn = hwy::HWY_NAMESPACE;

// ceil(distance / 128) for a distance = n . w, where the unit of n . q is 256: then -along < result <= along says that
// the voxel is the nearer end. w = 128 * whole + part, and likewise n, keep the terms within bounds, and their sum fits
// but for +2^31, which turns negative and is outside, too: for |n . w| is six times the volume of a tetrahedron with
// sides up to 2^12, at most 4 * (2^12)^3.
template <class D, class V>
HWY_INLINE V Distance(D d, const std::array<V, 3>& n, const std::array<V, 3>& w) {
  const V low_bits = hn::Set(d, 127);
  V whole = hn::Zero(d), part = low_bits;
  for (size_t m = 0; m < 3; ++m) {
    const V low = hn::And(w[m], low_bits);
    whole = hn::Add(whole, hn::Add(hn::Mul(n[m], hn::ShiftRight<7>(w[m])), hn::Mul(hn::ShiftRight<7>(n[m]), low)));
    part = hn::Add(part, hn::Mul(hn::And(n[m], low_bits), low));
  }
  return hn::Add(whole, hn::ShiftRight<7>(part));
}

// The same where the sum may take 54 bits or more, as doubles. Terms may take more than 64 bits; their sum does not
// where the voxel is as close to the plane as candidates are. Where it is not, doubles say so: infinity.
template <class D>
HWY_INLINE hn::Vec<D> WideDistance(D d, const std::array<hn::Vec<D>, 3>& n, const std::array<hn::Vec<D>, 3>& w) {
  constexpr size_t kCount = hn::MaxLanes(D());
  alignas(64) double normal[3][kCount], offset[3][kCount], distance[kCount];
  for (size_t m = 0; m < 3; ++m) {
    hn::Store(n[m], d, normal[m]);
    hn::Store(w[m], d, offset[m]);
  }
  for (size_t lane = 0; lane < kCount; ++lane) {
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

// Of each lane's triangle, its corners in lattice units from the voxel, by axis. Precondition: T holds the products of
// the lanes that count.
template <class T>
HWY_INLINE void Stars(const std::vector<ScanFrame>& frames, int32_t reach,
                      const std::array<std::array<hn::Vec<hn::ScalableTag<T> >, 3>, 3>& v, StarEdges* out) {
  const hn::ScalableTag<T> d;
  using V = hn::Vec<decltype(d)>;
  using V3 = std::array<V, 3>;
  const V zero = hn::Zero(d);
  const auto minus = [](const V3& a, const V3& b) {
    return V3{hn::Sub(a[0], b[0]), hn::Sub(a[1], b[1]), hn::Sub(a[2], b[2])};
  };
  const auto minor = [](V a, V b, V c, V e) { return hn::Sub(hn::Mul(a, e), hn::Mul(b, c)); };
  const auto cross = [&](const V3& a, const V3& b) {
    return V3{minor(a[1], a[2], b[1], b[2]), minor(a[2], a[0], b[2], b[0]), minor(a[0], a[1], b[0], b[1])};
  };
  const auto times = [&](int32_t c, V v) {
    return c == 0 ? zero : c == 1 ? v : c == -1 ? hn::Neg(v) : hn::Mul(hn::Set(d, static_cast<T>(c)), v);
  };

  V3 normal = cross(minus(v[1], v[0]), minus(v[2], v[0]));
  // Turned so that the normal's first nonzero entry is positive: that reverses all products.
  const auto first_nonzero = [&](const V3& a) HWY_ATTR {
    return hn::IfThenElse(hn::Eq(a[0], zero), hn::IfThenElse(hn::Eq(a[1], zero), a[2], a[1]), a[0]);
  };
  const auto reversed = hn::Lt(first_nonzero(normal), zero);
  const auto turn = [&](V3& a) {
    for (V& x : a) x = hn::IfThenElse(reversed, hn::Neg(x), x);
  };
  // (B - A) x (z - A) = A x B for z at the origin.
  std::array<V3, 3> moment;
  for (size_t n = 0; n < 3; ++n) {
    moment[n] = cross(v[n], v[(n + 1) % 3]);
    turn(moment[n]);
  }
  turn(normal);
  const V3 offset{hn::Neg(v[0][0]), hn::Neg(v[0][1]), hn::Neg(v[0][2])};
  V distance;
  if constexpr (sizeof(T) == 4) {
    distance = Distance(d, normal, offset);
  } else {
    distance = WideDistance(d, normal, offset);
  }
  const auto below = hn::Not(hn::Gt(distance, zero));

  // Whether the shift moves the line through the voxel along u, which is q, or -q unless `up`, to the inner side of the
  // triangle's edge n: s . (edge x u) > 0.
  const auto tie_is_inside = [&](size_t n, const Vec3i& q, hn::Mask<decltype(d)> up) HWY_ATTR {
    V3 edge = minus(v[(n + 1) % 3], v[n]);
    turn(edge);
    const V3 by{hn::Sub(times(q[2], edge[1]), times(q[1], edge[2])),
                hn::Sub(times(q[0], edge[2]), times(q[2], edge[0])),
                hn::Sub(times(q[1], edge[0]), times(q[0], edge[1]))};
    const V first_by = first_nonzero(by);
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
    const V bit = hn::Set(d, static_cast<T>(1 << n));
    nearer = hn::Add(nearer, hn::IfThenElseZero(meets, bit));
    forward = hn::Add(forward, hn::IfThenElseZero(hn::And(meets, hn::Not(hn::Xor(up, below))), bit));
  }
  const hn::Rebind<int32_t, decltype(d)> ints;
  int32_t bits[2][hn::MaxLanes(d)];
  if constexpr (sizeof(T) == 4) {
    hn::StoreU(nearer, ints, bits[0]);
    hn::StoreU(forward, ints, bits[1]);
  } else {
    hn::StoreU(hn::DemoteTo(ints, nearer), ints, bits[0]);
    hn::StoreU(hn::DemoteTo(ints, forward), ints, bits[1]);
  }
  for (size_t n = 0; n < hn::MaxLanes(d); ++n) {
    out[n] = {static_cast<uint32_t>(bits[0][n]), static_cast<uint32_t>(bits[1][n])};
  }
}

// Pairs in the lanes: the triangles' corners in lattice units from the voxels.
struct PairLanes {
  std::array<Ints3, 3> v;
  uint64_t near, middle, far;  // bit n: int32 holds the products of lane n; doubles do; neither does

  HWY_INLINE PairLanes(const std::array<Ints3, 3>& corners, const Ints3& voxel, size_t count) : v(corners) {
    const Lanes d;
    Ints farthest = hn::Zero(d);
    for (Ints3& corner : v) {
      corner = Minus(corner, voxel);
      for (const Ints x : corner) farthest = hn::Max(farthest, hn::Abs(x));
    }
    const auto within = [&](int bits) HWY_ATTR { return BitsOf(hn::Not(hn::Gt(farthest, Fill(1 << bits)))); };
    const uint64_t given = BitsOf(hn::FirstN(d, count)), narrow = within(kOffsetBits<int32_t>);
    const uint64_t wide = within(kOffsetBits<double>);
    near = given & narrow;
    middle = given & wide & ~narrow;
    far = given & ~wide;
  }
};

// Finds those of the lanes in `which`, of which doubles hold the products; out[n] gets lane n's.
HWY_INLINE void WideStars(const std::vector<ScanFrame>& frames, int32_t reach, const std::array<Ints3, 3>& v,
                          uint64_t which, StarEdges* out) {
  const hn::ScalableTag<double> d;
  constexpr size_t kCount = HWY_LANES(double), kParts = kTriangleLanes / kCount;
  const auto wanted = hn::LoadMaskBits(Lanes(), reinterpret_cast<const uint8_t*>(&which));
  alignas(64) int32_t ints[3][3][kTriangleLanes];
  for (size_t c = 0; c < 3; ++c) {
    for (size_t m = 0; m < 3; ++m) hn::Store(hn::IfThenElseZero(wanted, v[c][m]), Lanes(), ints[c][m]);
  }
  for (size_t part = 0; part < kParts; ++part) {
    uint64_t some = which >> part * kCount & ((uint64_t{1} << kCount) - 1);
    if (some == 0) continue;
    std::array<std::array<hn::Vec<decltype(d)>, 3>, 3> wide;
    for (size_t c = 0; c < 3; ++c) {
      for (size_t m = 0; m < 3; ++m) {
        wide[c][m] = hn::PromoteTo(d, hn::LoadU(hn::Rebind<int32_t, decltype(d)>(), ints[c][m] + part * kCount));
      }
    }
    StarEdges edges[kCount];
    Stars<double>(frames, reach, wide, edges);
    for (; some != 0; some &= some - 1) {
      const auto n = static_cast<size_t>(std::countr_zero(some));
      out[part * kCount + n] = edges[n];
    }
  }
}

void FindInLanes(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const BitsLayout& layout,
                 std::span<const VoxelTriangle> pairs, StarEdges* out) {
  const PaddedVertices vertices(mesh);
  int32_t reach = 0;
  for (const ScanFrame& scan : frames) {
    for (const int32_t q : scan.frame.q) reach = std::max(reach, std::abs(q));
  }
  constexpr size_t kAtOnce = 64;
  for (; !pairs.empty(); pairs = pairs.subspan(std::min(kAtOnce, pairs.size()))) {
    const size_t count = std::min(kAtOnce, pairs.size());
    // All voxels first: what was just written number by number cannot be read as a vector at once.
    int32_t voxels[3][kAtOnce];
    for (size_t n = 0; n < count; ++n) {
      hwy::Prefetch(&mesh.triangles[pairs[n].triangle]);
      const Vec3i z = layout.VoxelAt(pairs[n].voxel) * kLatticeUnit;
      for (size_t m = 0; m < 3; ++m) voxels[m][n] = z[m];
    }
    std::array<uint32_t, 3> corners[kAtOnce];
    for (size_t n = 0; n < count; ++n) {
      corners[n] = mesh.triangles[pairs[n].triangle];
      for (const uint32_t vertex : corners[n]) hwy::Prefetch(vertices[vertex]);
    }
    std::fill(corners + count, std::end(corners), corners[0]);
    for (auto& of_axis : voxels) std::fill(of_axis + count, std::end(of_axis), of_axis[0]);
    for (size_t first = 0; first < count; first += kTriangleLanes, out += kTriangleLanes) {
      const auto some = pairs.subspan(first, std::min(kTriangleLanes, count - first));
      const Lanes d;
      const PairLanes lanes(
          LoadCorners([&](size_t c, size_t n) HWY_ATTR { return vertices[corners[first + n][c]]; }),
          {hn::LoadU(d, voxels[0] + first), hn::LoadU(d, voxels[1] + first), hn::LoadU(d, voxels[2] + first)},
          some.size());
      StarEdges edges[kTriangleLanes];
      if (lanes.near != 0) Stars<int32_t>(frames, reach, lanes.v, edges);
      if (lanes.middle != 0) WideStars(frames, reach, lanes.v, lanes.middle, edges);
      for (uint64_t far = lanes.far; far != 0; far &= far - 1) {
        const auto& [voxel, triangle] = some[static_cast<size_t>(std::countr_zero(far))];
        edges[std::countr_zero(far)] = ScalarStarEdges(TriangleOf(mesh, triangle), frames, layout.VoxelAt(voxel));
      }
      std::copy_n(edges, some.size(), out);
    }
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

void FindStarEdges(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const BitsLayout& layout,
                   std::span<const VoxelTriangle> pairs, StarEdges* out) {
  SimdIsScalar() ? FindScalar(mesh, frames, layout, pairs, out)
                 : HWY_DYNAMIC_DISPATCH(FindInLanes)(mesh, frames, layout, pairs, out);
}

}  // namespace latvox
#endif  // HWY_ONCE
