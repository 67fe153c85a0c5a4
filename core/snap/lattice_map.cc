// All kernels evaluate the same expression, because digests depend on its rounding: the target has no contraction.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/snap/lattice_map.cc"
#include "core/snap/lattice_map.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <cstring>

#include "core/snap/snap.h"

// The code that does not depend on the instruction set, once.
#ifndef LATVOX_CORE_SNAP_LATTICE_MAP_ONCE_
#define LATVOX_CORE_SNAP_LATTICE_MAP_ONCE_

namespace latvox {
namespace {

// x + kRounder - kRounder rounds x half to even to an integer, for |x| < 2^51: doubles above 2^52 have no fractions.
constexpr double kRounder = 0x1.8p52;
static_assert(kPositionBits + kSubvoxelBits < 51);

// Vertex: Vec3f or Vec3d.
template <class Vertex>
Vec3d ToLattice(const LatticeMap& map, const Vertex& p) {
  const Vec3d d{p[0] - map.origin[0], p[1] - map.origin[1], p[2] - map.origin[2]};
  Vec3d v;
  for (size_t m = 0; m < 3; ++m) {
    v[m] = (map.inverse[0][m] * d[0] + map.inverse[1][m] * d[1]) + map.inverse[2][m] * d[2];
  }
  return v;
}

template <class Vertex>
LatticeRange PlainRangeOf(const LatticeMap& map, const Vertex* vertices, size_t count) {
  LatticeRange range;
  for (size_t n = 0; n < count; ++n) {
    const Vec3d v = ToLattice(map, vertices[n]);
    range.Add({v, v});
  }
  return range;
}

template <class Vertex>
void PlainRoundVertices(const LatticeMap& map, const LatticeRange& range, const Vec3i& base_ijk, const Vertex* vertices,
                        size_t count, Vec3i* out) {
  for (size_t n = 0; n < count; ++n) {
    // Copied by bytes, and so is the result: the compiler may assume that different types use different memory.
    Vertex p;
    std::memcpy(&p, vertices + n, sizeof(p));
    const Vec3d v = ToLattice(map, p);
    Vec3i rounded;
    for (size_t m = 0; m < 3; ++m) {
      const double clamped = std::min(std::max(range.min[m], v[m]), range.max[m]);
      const double units = (clamped * kLatticeUnit + kRounder) - kRounder;
      rounded[m] = static_cast<int32_t>(units - static_cast<double>(base_ijk[m]) * kLatticeUnit);
    }
    std::memcpy(out + n, &rounded, sizeof(rounded));
  }
}

}  // namespace
}  // namespace latvox

#endif  // LATVOX_CORE_SNAP_LATTICE_MAP_ONCE_

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::ScalableTag<double>;
using V = hn::Vec<D>;

struct Vertices {
  V x, y, z;
};

HWY_INLINE Vertices Load(const Vec3f* vertices) {
  const D d;
  const hn::Rebind<float, D> narrow;
  hn::Vec<hn::Rebind<float, D>> x, y, z;
  hn::LoadInterleaved3(narrow, vertices->data(), x, y, z);
  return {hn::PromoteTo(d, x), hn::PromoteTo(d, y), hn::PromoteTo(d, z)};
}

HWY_INLINE Vertices Load(const Vec3d* vertices) {
  Vertices v;
  hn::LoadInterleaved3(D(), vertices->data(), v.x, v.y, v.z);
  return v;
}

// ToLattice of Lanes(D) vertices.
template <class Vertex>
HWY_INLINE Vertices LoadLattice(const LatticeMap& map, const Vertex* vertices) {
  const D d;
  const Vertices v = Load(vertices);
  const V dx = hn::Sub(v.x, hn::Set(d, map.origin[0]));
  const V dy = hn::Sub(v.y, hn::Set(d, map.origin[1]));
  const V dz = hn::Sub(v.z, hn::Set(d, map.origin[2]));
  const auto row = [&](size_t m) HWY_ATTR {
    return hn::Add(hn::Add(hn::Mul(hn::Set(d, map.inverse[0][m]), dx), hn::Mul(hn::Set(d, map.inverse[1][m]), dy)),
                   hn::Mul(hn::Set(d, map.inverse[2][m]), dz));
  };
  return {row(0), row(1), row(2)};
}

template <class Vertex>
HWY_INLINE LatticeRange RangeOfAny(const LatticeMap& map, const Vertex* vertices, size_t count) {
  const D d;
  const size_t lanes = hn::Lanes(d);
  LatticeRange range;
  V low_x = hn::Set(d, range.min[0]), low_y = low_x, low_z = low_x;
  V high_x = hn::Set(d, range.max[0]), high_y = high_x, high_z = high_x;
  size_t n = 0;
  for (; n + lanes <= count; n += lanes) {
    const Vertices v = LoadLattice(map, vertices + n);
    low_x = hn::Min(v.x, low_x);
    low_y = hn::Min(v.y, low_y);
    low_z = hn::Min(v.z, low_z);
    high_x = hn::Max(v.x, high_x);
    high_y = hn::Max(v.y, high_y);
    high_z = hn::Max(v.z, high_z);
  }
  range.min = {hn::GetLane(hn::MinOfLanes(d, low_x)), hn::GetLane(hn::MinOfLanes(d, low_y)),
               hn::GetLane(hn::MinOfLanes(d, low_z))};
  range.max = {hn::GetLane(hn::MaxOfLanes(d, high_x)), hn::GetLane(hn::MaxOfLanes(d, high_y)),
               hn::GetLane(hn::MaxOfLanes(d, high_z))};
  range.Add(PlainRangeOf(map, vertices + n, count - n));
  return range;
}

template <class Vertex>
HWY_INLINE void RoundAny(const LatticeMap& map, const LatticeRange& range, const Vec3i& base_ijk,
                         const Vertex* vertices, size_t count, Vec3i* out) {
  const D d;
  const hn::Rebind<int32_t, D> narrow;
  const size_t lanes = hn::Lanes(d);
  const auto rounded = [&](V v, size_t m) HWY_ATTR {
    const V rounder = hn::Set(d, kRounder);
    const V clamped = hn::Min(hn::Max(v, hn::Set(d, range.min[m])), hn::Set(d, range.max[m]));
    const V units = hn::Sub(hn::Add(hn::Mul(clamped, hn::Set(d, double{kLatticeUnit})), rounder), rounder);
    return hn::DemoteTo(narrow, hn::Sub(units, hn::Set(d, static_cast<double>(base_ijk[m]) * kLatticeUnit)));
  };
  size_t n = 0;
  for (; n + lanes <= count; n += lanes) {
    const Vertices v = LoadLattice(map, vertices + n);
    hn::StoreInterleaved3(rounded(v.x, 0), rounded(v.y, 1), rounded(v.z, 2), narrow, out[n].data());
  }
  PlainRoundVertices(map, range, base_ijk, vertices + n, count - n, out + n);
}

LatticeRange RangeOfFloats(const LatticeMap& map, const Vec3f* vertices, size_t count) {
  return RangeOfAny(map, vertices, count);
}

LatticeRange RangeOfDoubles(const LatticeMap& map, const Vec3d* vertices, size_t count) {
  return RangeOfAny(map, vertices, count);
}

void RoundFloats(const LatticeMap& map, const LatticeRange& range, const Vec3i& base_ijk, const Vec3f* vertices,
                 size_t count, Vec3i* out) {
  RoundAny(map, range, base_ijk, vertices, count, out);
}

void RoundDoubles(const LatticeMap& map, const LatticeRange& range, const Vec3i& base_ijk, const Vec3d* vertices,
                  size_t count, Vec3i* out) {
  RoundAny(map, range, base_ijk, vertices, count, out);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include "core/base/simd.h"

namespace latvox {

HWY_EXPORT(RangeOfFloats);
HWY_EXPORT(RangeOfDoubles);
HWY_EXPORT(RoundFloats);
HWY_EXPORT(RoundDoubles);

void LatticeRange::Add(const LatticeRange& other) {
  for (size_t m = 0; m < 3; ++m) {
    min[m] = std::min(min[m], other.min[m]);
    max[m] = std::max(max[m], other.max[m]);
  }
}

LatticeRange RangeOf(const LatticeMap& map, const Vec3f* vertices, size_t count) {
  if (SimdIsScalar()) return PlainRangeOf(map, vertices, count);
  return HWY_DYNAMIC_DISPATCH(RangeOfFloats)(map, vertices, count);
}

LatticeRange RangeOf(const LatticeMap& map, const Vec3d* vertices, size_t count) {
  if (SimdIsScalar()) return PlainRangeOf(map, vertices, count);
  return HWY_DYNAMIC_DISPATCH(RangeOfDoubles)(map, vertices, count);
}

void RoundVertices(const LatticeMap& map, const LatticeRange& range, const Vec3i& base_ijk, const Vec3f* vertices,
                   size_t count, Vec3i* out) {
  if (SimdIsScalar()) return PlainRoundVertices(map, range, base_ijk, vertices, count, out);
  HWY_DYNAMIC_DISPATCH(RoundFloats)(map, range, base_ijk, vertices, count, out);
}

void RoundVertices(const LatticeMap& map, const LatticeRange& range, const Vec3i& base_ijk, const Vec3d* vertices,
                   size_t count, Vec3i* out) {
  if (SimdIsScalar()) return PlainRoundVertices(map, range, base_ijk, vertices, count, out);
  HWY_DYNAMIC_DISPATCH(RoundDoubles)(map, range, base_ijk, vertices, count, out);
}

}  // namespace latvox

#endif  // HWY_ONCE
