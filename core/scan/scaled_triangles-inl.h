// Triangles in lanes as floats, with bounded errors.
#if defined(LATVOX_CORE_SCAN_SCALED_TRIANGLES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_SCAN_SCALED_TRIANGLES_INL_H_
#undef LATVOX_CORE_SCAN_SCALED_TRIANGLES_INL_H_
#else
#define LATVOX_CORE_SCAN_SCALED_TRIANGLES_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>

#include "core/triangles/triangle_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET != HWY_SCALAR

namespace hn = hwy::HWY_NAMESPACE;

using Float = hn::ScalableTag<float>;
using Floats = hn::Vec<Float>;
using Floats3 = std::array<Floats, 3>;

// Bounds of errors, with w for the largest |coordinate| of a corner, seen from the voxel, up to 2^24; r for the largest
// |entry| of a direction; and u = 2^-24 for a rounding:
//
//   value                                           at most   wrong by at most
//   entry of a scaled edge, with any factor         1         2u: a difference and a product
//   entry a * d - b * c of a moment                 2w        8uw
//   entry of the normal                             2         12u
//   product of the normal with a direction          6r        (3 * 12 + 6 + 10) ur = 52 ur
//   product of a moment with a direction            6rw       (3 * 8 + 6 + 10) urw = 40 urw
//   product of the normal with the first corner     6w        (3 * 12 + 6 + 10) uw = 52 uw
//
// The sums have the errors of three entries, the roundings of three products, and those of their sum. Terms with u^2,
// and the roundings of these bounds, are less than the gaps to 56 and 44. A rounded difference that is compared with a
// float needs no more, because rounding is monotone. Contraction to fused products leaves roundings out.
inline constexpr float kUnit = 0x1p-24F, kNormalError = 56 * kUnit, kMomentError = 44 * kUnit;

// Triangles in lanes, whose edges are divided by their largest |entry|. The division changes no sign, and makes errors
// relative to the edges. Errors relative to the square of the farthest corner left many long thin triangles open.
struct ScaledTriangles {
  Floats3 normal;
  std::array<Floats3, 3> moment;  // of the edges

  HWY_INLINE explicit ScaledTriangles(const std::array<Floats3, 3>& v) {
    const Float d;
    std::array<Floats3, 3> edge;
    std::array<Floats, 3> length;
    for (size_t n = 0; n < 3; ++n) {
      edge[n] = Minus(v[(n + 1) % 3], v[n]);
      length[n] = hn::Max(hn::Max(hn::Abs(edge[n][0]), hn::Abs(edge[n][1])), hn::Abs(edge[n][2]));
      const Floats by = hn::Div(hn::Set(d, 1), hn::Max(length[n], hn::Set(d, 1)));  // edges without length stay 0
      for (Floats& entry : edge[n]) entry = hn::Mul(entry, by);
      // (B - A) x (z - A) = A x (B - A) for z at the origin.
      moment[n] = CrossOf(v[n], edge[n]);
    }
    // The shortest edge must be a factor of the normal, because the two others may be nearly parallel.
    const auto is_1 = hn::Lt(length[1], length[0]), is_2 = hn::Lt(length[2], hn::Min(length[0], length[1]));
    Floats3 shortest, next;
    for (size_t m = 0; m < 3; ++m) {
      shortest[m] = hn::IfThenElse(is_2, edge[2][m], hn::IfThenElse(is_1, edge[1][m], edge[0][m]));
      next[m] = hn::IfThenElse(is_2, edge[0][m], hn::IfThenElse(is_1, edge[2][m], edge[1][m]));
    }
    normal = CrossOf(shortest, next);
  }
};

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
