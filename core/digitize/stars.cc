// Voxel-triangle pairs in the lanes; direction after direction. The products are those of core/digitize/star.h.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/digitize/stars.cc"
#include "core/digitize/stars.h"

#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <bit>

#include "core/digitize/star.h"
#include "core/snap/padded_vertices.h"

namespace latvox {
#ifndef LATVOX_CORE_DIGITIZE_STARS_CC_ONCE
#define LATVOX_CORE_DIGITIZE_STARS_CC_ONCE
namespace {

// How far a triangle's corners may be from the voxel, per axis in lattice units, so that T holds all products. With
// offsets of b bits, sides have b + 1 bits, normals 2 * b + 2 (twice an area within a square of sides), moments
// 2 * b + 1, these with q 3 more, and distances, which only doubles hold as they are, 3 * b + 4.
template <class T>
inline constexpr int kOffsetBits = sizeof(T) == 4 ? 12 : 16;
static_assert(kMaxDirection <= 8 && 2 * kOffsetBits<int32_t> + 2 + 3 <= 30 && 3 * kOffsetBits<double> + 4 <= 53);
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
};

// ceil(distance / 128) for a distance = n . w, where the unit of n . q is 256: then -along < result <= along says that
// the voxel is the nearer end. For int32, w = 128 * whole + part, and likewise n, keep the terms within bounds, and
// their sum fits but for +2^31, which turns negative and is outside, too: for |n . w| is six times the volume of a
// tetrahedron with sides up to 2^12, at most 4 * (2^12)^3.
template <class D, class V>
HWY_INLINE V Distance(D d, const std::array<V, 3>& n, const std::array<V, 3>& w) {
  if constexpr (sizeof(hn::TFromD<D>) == 8) {
    const V sum = hn::Add(hn::Add(hn::Mul(n[0], w[0]), hn::Mul(n[1], w[1])), hn::Mul(n[2], w[2]));
    return hn::Mul(sum, hn::Set(d, 1.0 / 128));
  } else {
    const V low_bits = hn::Set(d, 127);
    V whole = hn::Zero(d), part = low_bits;
    for (size_t m = 0; m < 3; ++m) {
      const V low = hn::And(w[m], low_bits);
      whole = hn::Add(whole, hn::Add(hn::Mul(n[m], hn::ShiftRight<7>(w[m])), hn::Mul(hn::ShiftRight<7>(n[m]), low)));
      part = hn::Add(part, hn::Mul(hn::And(n[m], low_bits), low));
    }
    return hn::Add(whole, hn::ShiftRight<7>(part));
  }
}

// Lanes in `ties` are undecided.
template <class T>
HWY_INLINE void Stars(const std::vector<ScanFrame>& frames, const Corners<T>& corners, StarEdges* out, uint64_t& ties) {
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
  const auto dot = [&](const Vec3i& q, const V3& v) {
    return hn::Add(hn::Add(times(q[0], v[0]), times(q[1], v[1])), times(q[2], v[2]));
  };

  std::array<V3, 3> v, moment;
  for (size_t n = 0; n < 3; ++n) {
    V unused;
    hn::LoadInterleaved4(d, corners.of[n][0], v[n][0], v[n][1], v[n][2], unused);
  }
  V3 normal = cross(minus(v[1], v[0]), minus(v[2], v[0]));
  // Turned so that the normal's first nonzero entry is positive: that reverses all products.
  const V first =
      hn::IfThenElse(hn::Eq(normal[0], zero), hn::IfThenElse(hn::Eq(normal[1], zero), normal[2], normal[1]), normal[0]);
  const auto reversed = hn::Lt(first, zero);
  const auto turn = [&](V3& a) {
    for (V& x : a) x = hn::IfThenElse(reversed, hn::Neg(x), x);
  };
  // (B - A) x (z - A) = A x B for z at the origin.
  for (size_t n = 0; n < 3; ++n) {
    moment[n] = cross(v[n], v[(n + 1) % 3]);
    turn(moment[n]);
  }
  turn(normal);
  const V3 from_corner{hn::Neg(v[0][0]), hn::Neg(v[0][1]), hn::Neg(v[0][2])};
  const V distance = Distance(d, normal, from_corner);
  const auto below = hn::Not(hn::Gt(distance, zero));

  V nearer = zero, forward = zero;
  auto tied = hn::Lt(zero, zero);
  for (size_t n = 0; n < frames.size(); ++n) {
    const Vec3i& q = frames[n].frame.q;
    const V along = dot(q, normal), size = hn::Abs(along);
    auto meets = hn::And(hn::Lt(hn::Neg(size), distance), hn::Not(hn::Gt(distance, size)));
    if (hn::AllFalse(d, meets)) continue;
    const auto up = hn::Gt(along, zero);
    const V s0 = dot(q, moment[0]), s1 = dot(q, moment[1]), s2 = dot(q, moment[2]);
    const V least = hn::Min(s0, hn::Min(s1, s2)), most = hn::Max(s0, hn::Max(s1, s2));
    // All on the inner side: not negative, or not positive where u = -q.
    const V outermost = hn::IfThenElse(up, least, hn::Neg(most));
    meets = hn::And(meets, hn::Not(hn::Lt(outermost, zero)));
    tied = hn::Or(tied, hn::And(meets, hn::Eq(outermost, zero)));
    const V bit = hn::Set(d, static_cast<T>(1 << n));
    nearer = hn::Add(nearer, hn::IfThenElseZero(meets, bit));
    forward = hn::Add(forward, hn::IfThenElseZero(hn::And(meets, hn::Not(hn::Xor(up, below))), bit));
  }
  alignas(64) T bits[2][kLanesOf<T>];
  hn::Store(nearer, d, bits[0]);
  hn::Store(forward, d, bits[1]);
  for (size_t n = 0; n < kLanesOf<T>; ++n)
    out[n] = {static_cast<uint32_t>(bits[0][n]), static_cast<uint32_t>(bits[1][n])};
  ties = 0;
  hn::StoreMaskBits(d, tied, reinterpret_cast<uint8_t*>(&ties));
}

using FourInts = hn::CappedTag<int32_t, 4>;
using Four = hn::Vec<FourInts>;

// Whether no entry of the first three exceeds 2^bits in size.
HWY_INLINE bool Within(const std::array<Four, 3>& corners, int bits) {
  const FourInts d;
  const Four size = hn::Max(hn::Max(hn::Abs(corners[0]), hn::Abs(corners[1])), hn::Abs(corners[2]));
  return hn::AllFalse(d, hn::And(hn::Gt(size, hn::Set(d, 1 << bits)), hn::FirstN(d, 3)));
}

// Pairs that wait for the lanes to fill up.
template <class T>
class Batch {
 public:
  Batch(const std::vector<ScanFrame>& frames, StarEdges* out) : frames_(frames), out_(out) {}

  // `undecided` is told the indices of pairs with ties. Precondition: T holds the products.
  template <class F>
  HWY_INLINE void Add(size_t index, const std::array<Four, 3>& corners, F&& undecided) {
    const FourInts d4;
    const hn::Rebind<T, FourInts> d;
    for (size_t n = 0; n < 3; ++n) {
      if constexpr (sizeof(T) == 4) {
        hn::Store(corners[n], d, corners_.of[n][size_]);
      } else {
        alignas(16) int32_t ints[4] = {};
        hn::Store(corners[n], d4, ints);
        for (size_t m = 0; m < 4; ++m) corners_.of[n][size_][m] = ints[m];
      }
    }
    index_[size_++] = index;
    if (size_ == kLanesOf<T>) Flush(undecided);
  }
  template <class F>
  void Flush(F&& undecided) {
    if (size_ == 0) return;
    StarEdges edges[kLanesOf<T>];
    uint64_t ties;
    Stars(frames_, corners_, edges, ties);
    for (size_t n = 0; n < size_; ++n) {
      out_[index_[n]] = edges[n];
      if (ties >> n & 1) undecided(index_[n]);
    }
    size_ = 0;
  }

 private:
  const std::vector<ScanFrame>& frames_;
  StarEdges* out_;
  Corners<T> corners_;
  size_t index_[kLanesOf<T>];
  size_t size_ = 0;
};

void FindInLanes(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const BitsLayout& layout,
                 std::span<const VoxelTriangle> pairs, StarEdges* out) {
  Batch<int32_t> ints(frames, out);
  Batch<double> doubles(frames, out);
  const auto scalar = [&](size_t n) {
    out[n] = ScalarStarEdges(TriangleOf(mesh, pairs[n].triangle), frames, layout.VoxelAt(pairs[n].voxel));
  };
  const PaddedVertices vertices(mesh);
  const FourInts d;
  for (const auto& [voxel, triangle] : pairs) hwy::Prefetch(&mesh.triangles[triangle]);
  for (size_t n = 0; n < pairs.size(); ++n) {
    const Vec3i z = layout.VoxelAt(pairs[n].voxel) * kLatticeUnit;
    alignas(16) const int32_t at[4] = {z[0], z[1], z[2], 0};
    const auto& indices = mesh.triangles[pairs[n].triangle];
    std::array<Four, 3> corners;
    for (size_t m = 0; m < 3; ++m) corners[m] = hn::Sub(hn::LoadU(d, vertices[indices[m]]), hn::Load(d, at));
    if (Within(corners, kOffsetBits<int32_t>)) {
      ints.Add(n, corners, scalar);
    } else if (Within(corners, kOffsetBits<double>)) {
      doubles.Add(n, corners, scalar);
    } else {
      scalar(n);
    }
  }
  ints.Flush(scalar);
  doubles.Flush(scalar);
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
