// Voxel-triangle pairs in the lanes; direction after direction. The products are those of core/digitize/star.h.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/digitize/stars.cc"
#include "core/digitize/stars.h"

#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
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

template <class T>
inline constexpr size_t kLanesOf = HWY_LANES(T);

// Corners relative to the voxel, in lattice units: by corner and lane, each a vector of three and an unused number.
template <class T>
struct Corners {
  alignas(64) T of[3][kLanesOf<T>][4];
  alignas(64) T distance[kLanesOf<T>];  // of doubles
};

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

template <class T>
HWY_INLINE void Stars(const std::vector<ScanFrame>& frames, int32_t reach, const Corners<T>& corners, StarEdges* out) {
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

  std::array<V3, 3> v, moment;
  for (size_t n = 0; n < 3; ++n) {
    V unused;
    hn::LoadInterleaved4(d, corners.of[n][0], v[n][0], v[n][1], v[n][2], unused);
  }
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
  for (size_t n = 0; n < 3; ++n) {
    moment[n] = cross(v[n], v[(n + 1) % 3]);
    turn(moment[n]);
  }
  turn(normal);
  V distance;
  if constexpr (sizeof(T) == 4) {
    distance = Distance(d, normal, {hn::Neg(v[0][0]), hn::Neg(v[0][1]), hn::Neg(v[0][2])});
  } else {
    distance = hn::Load(d, corners.distance);
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
  alignas(64) T bits[2][kLanesOf<T>];
  hn::Store(nearer, d, bits[0]);
  hn::Store(forward, d, bits[1]);
  for (size_t n = 0; n < kLanesOf<T>; ++n)
    out[n] = {static_cast<uint32_t>(bits[0][n]), static_cast<uint32_t>(bits[1][n])};
}

using FourInts = hn::CappedTag<int32_t, 4>;
using Four = hn::Vec<FourInts>;

// How far the corners are away: of each axis the farthest, and 0.
HWY_INLINE Four FarthestOf(const std::array<Four, 3>& corners) {
  const FourInts d;
  const Four size = hn::Max(hn::Max(hn::Abs(corners[0]), hn::Abs(corners[1])), hn::Abs(corners[2]));
  return hn::IfThenElseZero(hn::FirstN(d, 3), size);
}

HWY_INLINE bool Within(Four farthest, int bits) {
  const FourInts d;
  return hn::AllFalse(d, hn::Gt(farthest, hn::Set(d, 1 << bits)));
}

HWY_INLINE void StoreDoubles(Four v, double* to) {
#if HWY_MAX_BYTES >= 32
  const hn::Rebind<double, FourInts> d;
  hn::Store(hn::PromoteTo(d, v), d, to);
#else  // targets without vectors of four doubles
  alignas(16) int32_t ints[4];
  hn::Store(v, FourInts(), ints);
  std::copy_n(ints, 4, to);
#endif
}

// Of triangles that int32 does not hold; mostly, several pairs of one follow each other.
class Normals {
 public:
  explicit Normals(const SnappedMesh& mesh) : mesh_(mesh) {}

  // ceil(n . (z - A) / 128), the triangle turned as Stars turns it, whose corner A is within 2^24 of z on each axis.
  // Terms may take more than 64 bits; their sum does not where z is as close to the plane as candidates are. Where it
  // is not, doubles say so: infinity.
  HWY_INLINE double Distance(uint32_t triangle, const int32_t (&corner)[4]) {
    if (triangle != triangle_) {
      triangle_ = triangle;
      normal_ = OrientedTriangle(TriangleOf(mesh_, triangle)).normal;
    }
    uint64_t distance = 0;  // modulo 2^64
    double estimate = 0;
    for (size_t m = 0; m < 3; ++m) {
      distance -= static_cast<uint64_t>(normal_[m]) * static_cast<uint64_t>(int64_t{corner[m]});
      estimate -= static_cast<double>(normal_[m]) * corner[m];
    }
    if (std::abs(estimate) > 0x1p62) return std::numeric_limits<double>::infinity();
    return static_cast<double>((static_cast<int64_t>(distance) + 127) >> 7);
  }

 private:
  const SnappedMesh& mesh_;
  uint32_t triangle_ = UINT32_MAX;
  Vec<int64_t, 3> normal_{};
};

// Pairs that wait for the lanes to fill up.
template <class T>
class Batch {
 public:
  explicit Batch(const std::vector<ScanFrame>& frames) : frames_(frames) {
    for (const ScanFrame& scan : frames) {
      for (const int32_t q : scan.frame.q) reach_ = std::max(reach_, std::abs(q));
    }
  }

  // `out` gets the edges when the lanes are full, or flushed. Precondition: T holds the products.
  HWY_INLINE void Add(StarEdges* out, const std::array<Four, 3>& corners, [[maybe_unused]] uint32_t triangle,
                      [[maybe_unused]] Normals& normals) {
    const FourInts d4;
    if constexpr (sizeof(T) == 4) {
      for (size_t n = 0; n < 3; ++n) hn::Store(corners[n], d4, corners_.of[n][size_]);
    } else {
      alignas(16) int32_t first[4];
      hn::Store(corners[0], d4, first);
      corners_.distance[size_] = normals.Distance(triangle, first);
      for (size_t n = 0; n < 3; ++n) StoreDoubles(corners[n], corners_.of[n][size_]);
    }
    out_[size_++] = out;
    if (size_ == kLanesOf<T>) Flush();
  }
  void Flush() {
    if (size_ == 0) return;
    StarEdges edges[kLanesOf<T>];
    Stars(frames_, reach_, corners_, edges);
    for (size_t n = 0; n < size_; ++n) *out_[n] = edges[n];
    size_ = 0;
  }

 private:
  const std::vector<ScanFrame>& frames_;
  int32_t reach_ = 0;  // the largest |entry| of their directions
  Corners<T> corners_;
  StarEdges* out_[kLanesOf<T>];
  size_t size_ = 0;
};

void FindInLanes(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const BitsLayout& layout,
                 std::span<const VoxelTriangle> pairs, StarEdges* out) {
  Batch<int32_t> ints(frames);
  Batch<double> doubles(frames);
  Normals normals(mesh);
  const PaddedVertices vertices(mesh);
  const FourInts d;
  constexpr size_t kAtOnce = 64;
  while (!pairs.empty()) {
    const size_t count = std::min(kAtOnce, pairs.size());
    // All voxels first: what was just written number by number cannot be read as a vector at once.
    alignas(16) int32_t voxels[kAtOnce][4];
    for (size_t n = 0; n < count; ++n) {
      hwy::Prefetch(&mesh.triangles[pairs[n].triangle]);
      const Vec3i z = layout.VoxelAt(pairs[n].voxel) * kLatticeUnit;
      for (size_t m = 0; m < 3; ++m) voxels[n][m] = z[m];
      voxels[n][3] = 0;
    }
    for (size_t n = 0; n < count; ++n) {
      const uint32_t triangle = pairs[n].triangle;
      const Four z = hn::Load(d, voxels[n]);
      std::array<Four, 3> corners;
      for (size_t m = 0; m < 3; ++m) corners[m] = hn::Sub(hn::LoadU(d, vertices[mesh.triangles[triangle][m]]), z);
      const Four farthest = FarthestOf(corners);
      if (Within(farthest, kOffsetBits<int32_t>)) {
        ints.Add(out + n, corners, triangle, normals);
      } else if (Within(farthest, kOffsetBits<double>)) {
        doubles.Add(out + n, corners, triangle, normals);
      } else {
        out[n] = ScalarStarEdges(TriangleOf(mesh, triangle), frames, layout.VoxelAt(pairs[n].voxel));
      }
    }
    pairs = pairs.subspan(count);
    out += count;
  }
  ints.Flush();
  doubles.Flush();
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
