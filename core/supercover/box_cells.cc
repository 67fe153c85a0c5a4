// Pairs of voxel and triangle in lanes of doubles, which hold all numbers here exactly.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/supercover/box_cells.cc"
#include "core/supercover/box_cells.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

#include "core/base/vec.h"
#include "core/triangles/triangle_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using CellLanes = hn::ScalableTag<double>;
using CellDoubles = hn::Vec<CellLanes>;
using CellDoubles3 = std::array<CellDoubles, 3>;

// The cell is the cube of U = kLatticeUnit about the origin. It reaches U/2 * (|a_0| + |a_1| + |a_2|) along an axis a.
// For the edge d from corner A to B and the unit vector u_m, the axis is d x u_m. There A and B are at (A x B)_m. The
// other corner is at (A x B)_m - n_m, because the normal n is the sum of the three products. Corners are below 2^25.1
// in size, so products are below 2^52, and the sum of two of them is below 2^53.
//   v   the triangle's corners, from the voxel, by axis in lattice units
HWY_INLINE hn::Mask<CellLanes> Separated(const std::array<CellDoubles3, 3>& v, bool is_near) {
  const CellLanes d;
  const CellDoubles half = hn::Set(d, kLatticeUnit / 2);
  auto separated = hn::FirstN(d, 0);
  const auto check = [&](CellDoubles low, CellDoubles high, CellDoubles reach) HWY_ATTR {
    separated = hn::Or(separated, hn::Or(hn::Gt(low, reach), hn::Lt(high, hn::Neg(reach))));
  };
  for (size_t m = 0; m < 3; ++m) {
    check(hn::Min(v[0][m], hn::Min(v[1][m], v[2][m])), hn::Max(v[0][m], hn::Max(v[1][m], v[2][m])), half);
  }
  std::array<CellDoubles3, 3> moment;
  for (size_t n = 0; n < 3; ++n) moment[n] = CrossOf(v[n], v[(n + 1) % 3]);
  CellDoubles3 normal;
  for (size_t m = 0; m < 3; ++m) normal[m] = hn::Add(hn::Add(moment[0][m], moment[1][m]), moment[2][m]);
  for (size_t n = 0; n < 3; ++n) {
    CellDoubles3 size;
    for (size_t m = 0; m < 3; ++m) size[m] = hn::Abs(hn::Sub(v[(n + 1) % 3][m], v[n][m]));
    for (size_t m = 0; m < 3; ++m) {
      const CellDoubles other = hn::Sub(moment[n][m], normal[m]);
      const CellDoubles reach = hn::Mul(half, hn::Add(size[(m + 1) % 3], size[(m + 2) % 3]));
      check(hn::Min(moment[n][m], other), hn::Max(moment[n][m], other), reach);
    }
  }
  if (is_near) return separated;
  CellDoubles at = hn::Zero(d), reach = at;
  for (size_t m = 0; m < 3; ++m) {
    at = hn::Add(at, hn::Mul(normal[m], v[0][m]));
    reach = hn::Add(reach, hn::Mul(half, hn::Abs(normal[m])));
  }
  check(at, at, reach);
  return separated;
}

void KeepMeetingInLanes(const SnappedMesh& mesh, const BitsLayout& layout, bool is_near,
                        std::vector<VoxelTriangle>& pairs) {
  const CellLanes d;
  constexpr size_t kAtOnce = 64, kLanes = HWY_LANES(double);
  static_assert(kAtOnce % kLanes == 0);
  alignas(64) double corners[3][3][kAtOnce] = {};
  size_t kept = 0;
  for (size_t first = 0; first < pairs.size(); first += kAtOnce) {
    // All numbers are written first, because numbers written one by one cannot be read as a vector at once.
    const size_t count = std::min(kAtOnce, pairs.size() - first);
    for (size_t n = 0; n < count; ++n) {
      const Vec3i voxel = layout.VoxelAt(pairs[first + n].voxel) * kLatticeUnit;
      const Triangle triangle = mesh.TriangleAt(pairs[first + n].triangle);
      for (size_t c = 0; c < 3; ++c) {
        for (size_t m = 0; m < 3; ++m) corners[c][m][n] = triangle[c][m] - voxel[m];
      }
    }
    for (size_t n = 0; n < count; n += kLanes) {
      std::array<CellDoubles3, 3> v;
      for (size_t c = 0; c < 3; ++c) {
        for (size_t m = 0; m < 3; ++m) v[c][m] = hn::Load(d, corners[c][m] + n);
      }
      uint64_t separated = 0;
      hn::StoreMaskBits(d, Separated(v, is_near), reinterpret_cast<uint8_t*>(&separated));
      for (size_t lane = n; lane < std::min(n + kLanes, count); ++lane, separated >>= 1) {
        pairs[kept] = pairs[first + lane];
        kept += (separated & 1) == 0 ? 1 : 0;
      }
    }
  }
  pairs.resize(kept);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace latvox {
namespace {

HWY_EXPORT(KeepMeetingInLanes);

using Vec3l = Vec<int64_t, 3>;

// Returns whether covector . v + (sum of the covector) U/2 is a multiple of U, with the covector divided by its common
// divisor. Computed modulo 2^64, which holds the low bits.
bool MayTouch(const Vec3l& covector, const Vec3i& v) {
  const auto touches = [&](const Vec3l& by) {
    uint64_t sum = 0;
    for (size_t m = 0; m < 3; ++m) {
      sum += static_cast<uint64_t>(by[m]) * (static_cast<uint64_t>(v[m]) + kLatticeUnit / 2);
    }
    return sum % kLatticeUnit == 0;
  };
  if (!touches(covector)) return false;
  const int64_t common = std::gcd(std::gcd(covector[0], covector[1]), covector[2]);
  return common == 0 || touches({covector[0] / common, covector[1] / common, covector[2] / common});
}

}  // namespace

bool ScanFindsCover(const Triangle& triangle) {
  // Not from 64-bit copies of the corners: compilers read numbers that were written one by one as vectors, which waits.
  const auto edge = [&](size_t from, size_t to) {
    Vec3l out;
    for (size_t m = 0; m < 3; ++m) out[m] = int64_t{triangle[to][m]} - triangle[from][m];
    return out;
  };
  const Vec3l normal = Cross(edge(0, 1), edge(0, 2));
  if (MayTouch(normal, triangle[0])) return false;  // also if it is 0
  Vec3l principal;                                  // the signs of the normal: see MakeScanFrames
  for (size_t m = 0; m < 3; ++m) principal[m] = (normal[m] > 0 ? 1 : 0) - (normal[m] < 0 ? 1 : 0);
  for (size_t n = 0; n < 3; ++n) {
    if (MayTouch(Cross(edge(n, (n + 1) % 3), principal), triangle[n])) return false;
  }
  return true;
}

void KeepMeeting(const SnappedMesh& mesh, const BitsLayout& layout, bool is_near, std::vector<VoxelTriangle>& pairs) {
  HWY_DYNAMIC_DISPATCH(KeepMeetingInLanes)(mesh, layout, is_near, pairs);
}

}  // namespace latvox
#endif  // HWY_ONCE
