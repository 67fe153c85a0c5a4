// A kernel looks at bounding boxes, with axes in lanes.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/solid/crossing_triangles.cc"
#include "core/solid/crossing_triangles.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>

// The code that does not depend on the instruction set, once.
#ifndef LATVOX_CORE_SOLID_CROSSING_TRIANGLES_ONCE_
#define LATVOX_CORE_SOLID_CROSSING_TRIANGLES_ONCE_

namespace latvox {
namespace {

// Bit n: whether two or three of the bits of n are set.
constexpr uint32_t kTwoAxes = 1U << 3 | 1U << 5 | 1U << 6 | 1U << 7;

// Writes the triangles that may cross a line to `out`, and returns their end.
uint32_t* PlainCrossing(const SnappedMesh& mesh, std::span<const uint32_t> triangles, uint32_t* out) {
  for (const uint32_t t : triangles) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3i &u = mesh.vertices_lat[a], &v = mesh.vertices_lat[b], &w = mesh.vertices_lat[c];
    uint32_t axes = 0;  // with an integer
    for (size_t m = 0; m < 3; ++m) {
      const int32_t least = std::min(std::min(u[m], v[m]), w[m]), most = std::max(std::max(u[m], v[m]), w[m]);
      axes |= (most & -kLatticeUnit) >= least ? 1U << m : 0;
    }
    *out = t;
    out += kTwoAxes >> axes & 1;
  }
  return out;
}

}  // namespace
}  // namespace latvox

#endif  // LATVOX_CORE_SOLID_CROSSING_TRIANGLES_ONCE_

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR  // which has no vectors of four

uint32_t* Crossing(const SnappedMesh& mesh, std::span<const uint32_t> triangles, uint32_t* out) {
  return PlainCrossing(mesh, triangles, out);
}

#else

namespace hn = hwy::HWY_NAMESPACE;

// Vertices are padded, so a vector of four may be read; the fourth lane is meaningless.
uint32_t* Crossing(const SnappedMesh& mesh, std::span<const uint32_t> triangles, uint32_t* out) {
  const hn::FixedTag<int32_t, 4> d;
  const auto whole = hn::Set(d, -kLatticeUnit);
  const auto corner = [&](uint32_t vertex) HWY_ATTR { return hn::LoadU(d, mesh.vertices_lat[vertex].data()); };
  for (const uint32_t t : triangles) {
    const auto& [a, b, c] = mesh.triangles[t];
    const auto u = corner(a), v = corner(b), w = corner(c);
    const auto least = hn::Min(hn::Min(u, v), w), most = hn::Max(hn::Max(u, v), w);
    uint64_t without = 0;  // an integer
    hn::StoreMaskBits(d, hn::Lt(hn::And(most, whole), least), reinterpret_cast<uint8_t*>(&without));
    *out = t;
    out += kTwoAxes >> (~without & 7) & 1;
  }
  return out;
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "core/base/simd.h"

namespace latvox {

HWY_EXPORT(Crossing);

void FindCrossing(const SnappedMesh& mesh, std::span<const uint32_t> triangles, StopSignal stop,
                  std::vector<uint32_t>& crossing) {
  constexpr size_t kPiece = 4096;  // triangles between two looks at the stop signal
  crossing.resize(triangles.size());
  uint32_t* end = crossing.data();
  for (size_t first = 0; first < triangles.size() && !stop.Stopped(); first += kPiece) {
    const auto piece = triangles.subspan(first, std::min(kPiece, triangles.size() - first));
    end = SimdIsScalar() ? PlainCrossing(mesh, piece, end) : HWY_DYNAMIC_DISPATCH(Crossing)(mesh, piece, end);
  }
  crossing.resize(static_cast<size_t>(end - crossing.data()));
}

}  // namespace latvox
#endif  // HWY_ONCE
