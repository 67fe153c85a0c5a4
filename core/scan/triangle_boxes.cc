// Triangles in lanes, voxel after voxel.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/scan/triangle_boxes.cc"
#include "core/scan/triangle_boxes.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <bit>

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// Bit n: the voxel lies in box first + n.
template <class D>
HWY_INLINE uint64_t BoxesAround(D d, const std::array<const uint8_t*, 6>& bounds, size_t first,
                                const std::array<hn::Vec<D>, 3>& voxel) {
  auto beyond = hn::Zero(d);  // 0 where it does
  for (size_t m = 0; m < 3; ++m) {
    const auto lowest = hn::LoadU(d, bounds[m] + first), highest = hn::LoadU(d, bounds[3 + m] + first);
    beyond = hn::Or(beyond, hn::Or(hn::SaturatedSub(lowest, voxel[m]), hn::SaturatedSub(voxel[m], highest)));
  }
  uint64_t inside = 0;
  hn::StoreMaskBits(d, hn::Eq(beyond, hn::Zero(d)), reinterpret_cast<uint8_t*>(&inside));
  return inside;
}

bool FindPairs(const std::array<const uint8_t*, 6>& bounds, const BitsLayout& layout, const Vec3i& low,
               std::span<const uint32_t> triangles, std::span<const uint32_t> voxels, size_t most,
               std::vector<VoxelTriangle>& pairs) {
  const hn::ScalableTag<uint8_t> d;
  constexpr size_t kLanes = HWY_LANES(uint8_t);
  static_assert(kLanes <= TriangleBoxes::kSlack && kLanes <= 64);
  pairs.resize(most + kLanes + 1);
  size_t count = 0;
  for (const uint32_t voxel : voxels) {
    const Vec3i ijk = layout.VoxelAt(voxel) - low;
    const std::array at{hn::Set(d, static_cast<uint8_t>(ijk[0])), hn::Set(d, static_cast<uint8_t>(ijk[1])),
                        hn::Set(d, static_cast<uint8_t>(ijk[2]))};
    for (size_t first = 0; first < triangles.size(); first += kLanes) {
      const size_t left = triangles.size() - first;
      uint64_t inside = BoxesAround(d, bounds, first, at) & (left < 64 ? (uint64_t{1} << left) - 1 : ~uint64_t{0});
      // Mostly there is one, or none, which nothing predicts.
      const auto add = [&] {
        const auto lane = static_cast<size_t>(std::countr_zero(inside));
        pairs[count] = {voxel, triangles[std::min(first + lane, triangles.size() - 1)]};
        count += inside != 0 ? 1 : 0;
        inside &= inside - 1;
      };
      add();
      while (inside != 0) add();
      if (count > most) return false;
    }
  }
  pairs.resize(count);
  return true;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace latvox {
namespace {

HWY_EXPORT(FindPairs);

}  // namespace

bool TriangleBoxes::FindPairs(const BitsLayout& layout, const Vec3i& low, std::span<const uint32_t> triangles,
                              std::span<const uint32_t> voxels, size_t most, std::vector<VoxelTriangle>& pairs) const {
  std::array<const uint8_t*, 6> bounds;
  for (size_t n = 0; n < 6; ++n) bounds[n] = bounds_[n].data();
  return HWY_DYNAMIC_DISPATCH(FindPairs)(bounds, layout, low, triangles, voxels, most, pairs);
}

}  // namespace latvox
#endif  // HWY_ONCE
