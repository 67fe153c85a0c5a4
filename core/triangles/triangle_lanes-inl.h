// Triangles in lanes: loads them, and computes with vectors of three.
#if defined(LATVOX_CORE_TRIANGLES_TRIANGLE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_TRIANGLES_TRIANGLE_LANES_INL_H_
#undef LATVOX_CORE_TRIANGLES_TRIANGLE_LANES_INL_H_
#else
#define LATVOX_CORE_TRIANGLES_TRIANGLE_LANES_INL_H_
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <span>

#include "core/lattice/frame.h"
#include "core/snap/snap.h"
#include "core/triangles/padded_vertices.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::ScalableTag<int32_t>;
using Ints = hn::Vec<Lanes>;
inline constexpr size_t kTriangleLanes = HWY_LANES(int32_t);

using Ints3 = std::array<Ints, 3>;

HWY_INLINE Ints Fill(int64_t x) { return hn::Set(Lanes(), static_cast<int32_t>(x)); }
template <class V>
HWY_INLINE std::array<V, 3> Minus(const std::array<V, 3>& a, const std::array<V, 3>& b) {
  return {hn::Sub(a[0], b[0]), hn::Sub(a[1], b[1]), hn::Sub(a[2], b[2])};
}
template <class V>
HWY_INLINE V DotOf(const std::array<V, 3>& a, const std::array<V, 3>& b) {
  return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
}
// Bit n of the result belongs to lane n.
HWY_INLINE uint64_t BitsOf(hn::Mask<Lanes> mask) {
  uint64_t bits = 0;
  hn::StoreMaskBits(Lanes(), mask, reinterpret_cast<uint8_t*>(&bits));
  return bits;
}
HWY_INLINE Ints3 Fill3(const Vec3i& v) { return {Fill(v[0]), Fill(v[1]), Fill(v[2])}; }
template <class V>
HWY_INLINE V Minor(V a, V b, V c, V d) {
  return hn::Sub(hn::Mul(a, d), hn::Mul(b, c));
}
template <class V>
HWY_INLINE std::array<V, 3> CrossOf(const std::array<V, 3>& a, const std::array<V, 3>& b) {
  return {Minor(a[1], a[2], b[1], b[2]), Minor(a[2], a[0], b[2], b[0]), Minor(a[0], a[1], b[0], b[1])};
}
template <class V>
HWY_INLINE V FirstNonzero(const std::array<V, 3>& v) {
  const V zero = hn::Zero(hn::DFromV<V>());
  return hn::IfThenElse(hn::Eq(v[0], zero), hn::IfThenElse(hn::Eq(v[1], zero), v[2], v[1]), v[0]);
}
HWY_INLINE Ints Least(Ints a, Ints b, Ints c) { return hn::Min(a, hn::Min(b, c)); }
HWY_INLINE Ints Most(Ints a, Ints b, Ints c) { return hn::Max(a, hn::Max(b, c)); }
HWY_INLINE int32_t MostOfLanes(Ints v) { return hn::GetLane(hn::MaxOfLanes(Lanes(), v)); }

// A form's values at three corners. Most coefficients are 0 or 1.
template <class D, class V = hn::Vec<D> >
HWY_INLINE std::array<V, 3> ValuesOf(D d, const Vec3i& form, const std::array<std::array<V, 3>, 3>& v) {
  std::array<V, 3> value{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
  for (size_t m = 0; m < 3; ++m) {
    if (form[m] == 0) continue;
    for (size_t c = 0; c < 3; ++c) {
      value[c] = form[m] == 1 ? hn::Add(value[c], v[c][m])
                 : form[m] == -1
                     ? hn::Sub(value[c], v[c][m])
                     : hn::Add(value[c], hn::Mul(hn::Set(d, static_cast<hn::TFromD<D> >(form[m])), v[c][m]));
    }
  }
  return value;
}

// Multiples of a vector of three, for products with many vectors of small integers.
template <class D>
class Multiples {
 public:
  using V = hn::Vec<D>;

  //   reach   the largest |entry| of those vectors
  HWY_INLINE Multiples(D d, const std::array<V, 3>& v, int32_t reach) {
    for (size_t m = 0; m < 3; ++m) {
      for (int32_t c = -reach; c <= reach; ++c) At(m, c) = hn::Mul(hn::Set(d, static_cast<hn::TFromD<D> >(c)), v[m]);
    }
  }

  HWY_INLINE V Dot(const Vec3i& q) const { return hn::Add(hn::Add(At(0, q[0]), At(1, q[1])), At(2, q[2])); }

 private:
  HWY_INLINE V& At(size_t m, int32_t c) { return of_[m][c + kMaxDirection]; }
  HWY_INLINE const V& At(size_t m, int32_t c) const { return of_[m][c + kMaxDirection]; }

  V of_[3][2 * kMaxDirection + 1];
};

// The numbers of up to kTriangleLanes triangles, padded with the last one's.
class LaneNumbers {
 public:
  HWY_INLINE explicit LaneNumbers(std::span<const uint32_t> triangles) : numbers_(triangles.data()) {
    if (triangles.size() >= kTriangleLanes) return;
    std::fill(std::copy(triangles.begin(), triangles.end(), padded_), padded_ + kTriangleLanes, triangles.back());
    numbers_ = padded_;
  }
  LaneNumbers(const LaneNumbers&) = delete;
  LaneNumbers& operator=(const LaneNumbers&) = delete;

  HWY_INLINE uint32_t operator[](size_t lane) const { return numbers_[lane]; }

 private:
  const uint32_t* numbers_;
  uint32_t padded_[kTriangleLanes];
};

#if HWY_TARGET != HWY_SCALAR  // which has no vectors of four

// Vectors of 128 bits side by side, at row(0), row(1), ... A way through memory would have to write them first, and a
// load waits for several stores that it spans.
template <size_t kFirst = 0, class D, class Row>
HWY_INLINE hn::Vec<D> LoadRows(D d, const Row& row) {
  constexpr size_t kRows = hn::MaxLanes(D()) * sizeof(hn::TFromD<D>) / 16;
  if constexpr (kRows == 1) {
    return hn::LoadU(d, row(kFirst));
  } else {
    const hn::Half<D> half;
    return hn::Combine(d, LoadRows<kFirst + kRows / 2>(half, row), LoadRows<kFirst>(half, row));
  }
}

// Within each four lanes, rows become columns; the last column is left out.
HWY_INLINE Ints3 ColumnsOf(const std::array<Ints, 4>& rows) {
  const Lanes d;
  const hn::Repartition<int64_t, Lanes> pairs;
  const auto x_y_01 = hn::BitCast(pairs, hn::InterleaveLower(d, rows[0], rows[1]));
  const auto x_y_23 = hn::BitCast(pairs, hn::InterleaveLower(d, rows[2], rows[3]));
  const auto z_01 = hn::BitCast(pairs, hn::InterleaveUpper(d, rows[0], rows[1]));
  const auto z_23 = hn::BitCast(pairs, hn::InterleaveUpper(d, rows[2], rows[3]));
  return {hn::BitCast(d, hn::InterleaveLower(pairs, x_y_01, x_y_23)),
          hn::BitCast(d, hn::InterleaveUpper(pairs, x_y_01, x_y_23)),
          hn::BitCast(d, hn::InterleaveLower(pairs, z_01, z_23))};
}

// The corners, by axis, of kTriangleLanes triangles: row(c, n) is corner c of the n-th.
template <class Row>
HWY_INLINE std::array<Ints3, 3> LoadCorners(const Row& row) {
  std::array<Ints3, 3> v;
  for (size_t c = 0; c < 3; ++c) {
    // A corner of every fourth triangle, from the first to the fourth on.
    const auto rows = [&](size_t first) HWY_ATTR {
      return LoadRows(Lanes(), [&](size_t m) HWY_ATTR { return row(c, 4 * m + first); });
    };
    v[c] = ColumnsOf({rows(0), rows(1), rows(2), rows(3)});
  }
  return v;
}

// Does the same in lattice units from `origin`.
HWY_INLINE std::array<Ints3, 3> LoadCorners(const SnappedMesh& mesh, const PaddedVertices& vertices,
                                            const LaneNumbers& triangles, const Vec3i& origin) {
  std::array<uint32_t, 3> corners[kTriangleLanes];
  for (size_t n = 0; n < kTriangleLanes; ++n) corners[n] = mesh.triangles[triangles[n]];
  std::array<Ints3, 3> v = LoadCorners([&](size_t c, size_t n) HWY_ATTR { return vertices[corners[n][c]]; });
  for (Ints3& corner : v) corner = Minus(corner, Fill3(origin));
  return v;
}

#endif

// Prefetches the corners of triangles that will be loaded some steps later. Neighbors in the list may be far apart in
// the mesh, and so may their vertices.
HWY_INLINE void PrefetchCorners(const SnappedMesh& mesh, std::span<const uint32_t> triangles) {
  constexpr size_t kVerticesAhead = 2 * kTriangleLanes, kTrianglesAhead = 4 * kTriangleLanes;
  if (triangles.size() < kTrianglesAhead + kTriangleLanes) return;
  for (size_t t = 0; t < kTriangleLanes; ++t) {
    hwy::Prefetch(&mesh.triangles[triangles[kTrianglesAhead + t]]);
    for (const uint32_t vertex : mesh.triangles[triangles[kVerticesAhead + t]]) {
      hwy::Prefetch(&mesh.vertices_lat[vertex]);
    }
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
