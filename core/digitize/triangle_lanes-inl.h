// Triangles in the lanes: reading them, and vectors of three.
#if defined(LATVOX_CORE_DIGITIZE_TRIANGLE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_DIGITIZE_TRIANGLE_LANES_INL_H_
#undef LATVOX_CORE_DIGITIZE_TRIANGLE_LANES_INL_H_
#else
#define LATVOX_CORE_DIGITIZE_TRIANGLE_LANES_INL_H_
#endif

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <span>

#include "core/snap/padded_vertices.h"
#include "core/snap/snap.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::ScalableTag<int32_t>;
using Ints = hn::Vec<Lanes>;
inline constexpr size_t kTriangleLanes = HWY_LANES(int32_t);

// Four integers for each lane.
struct alignas(64) LaneVectors {
  int32_t of[kTriangleLanes][4];
};

using Ints3 = std::array<Ints, 3>;

HWY_INLINE Ints Fill(int64_t x) { return hn::Set(Lanes(), static_cast<int32_t>(x)); }
HWY_INLINE Ints3 Minus(const Ints3& a, const Ints3& b) {
  return {hn::Sub(a[0], b[0]), hn::Sub(a[1], b[1]), hn::Sub(a[2], b[2])};
}
HWY_INLINE Ints DotOf(const Ints3& a, const Ints3& b) {
  return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
}
HWY_INLINE Ints3 Fill3(const Vec3i& v) { return {Fill(v[0]), Fill(v[1]), Fill(v[2])}; }
HWY_INLINE Ints Minor(Ints a, Ints b, Ints c, Ints d) { return hn::Sub(hn::Mul(a, d), hn::Mul(b, c)); }
HWY_INLINE Ints3 CrossOf(const Ints3& a, const Ints3& b) {
  return {Minor(a[1], a[2], b[1], b[2]), Minor(a[2], a[0], b[2], b[0]), Minor(a[0], a[1], b[0], b[1])};
}
HWY_INLINE Ints FirstNonzero(const Ints3& v) {
  const Ints zero = hn::Zero(Lanes());
  return hn::IfThenElse(hn::Eq(v[0], zero), hn::IfThenElse(hn::Eq(v[1], zero), v[2], v[1]), v[0]);
}
HWY_INLINE Ints Least(Ints a, Ints b, Ints c) { return hn::Min(a, hn::Min(b, c)); }
HWY_INLINE Ints Most(Ints a, Ints b, Ints c) { return hn::Max(a, hn::Max(b, c)); }

// The corners, by axis, of up to kTriangleLanes triangles, in lattice units from `origin`; the last triangle's in the
// lanes that are left.
HWY_INLINE std::array<Ints3, 3> LoadCorners(const SnappedMesh& mesh, const PaddedVertices& vertices,
                                            std::span<const uint32_t> triangles, const Vec3i& origin) {
  const hn::CappedTag<int32_t, 4> d4;
  LaneVectors corner[3];
  for (size_t t = 0; t < kTriangleLanes; ++t) {
    const auto& indices = mesh.triangles[triangles[std::min(t, triangles.size() - 1)]];
    for (size_t n = 0; n < 3; ++n) hn::Store(hn::LoadU(d4, vertices[indices[n]]), d4, corner[n].of[t]);
  }
  std::array<Ints3, 3> v;
  for (size_t n = 0; n < 3; ++n) {
    Ints unused;
    hn::LoadInterleaved4(Lanes(), corner[n].of[0], v[n][0], v[n][1], v[n][2], unused);
    v[n] = Minus(v[n], Fill3(origin));
  }
  return v;
}

// Asks memory for the corners of triangles that will be loaded some steps from here: neighbours in the list may be far
// apart in the mesh, and so are their vertices.
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
