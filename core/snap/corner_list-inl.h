// Reading corners out of a list into lanes.
#if defined(LATVOX_CORE_SNAP_CORNER_LIST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_SNAP_CORNER_LIST_INL_H_
#undef LATVOX_CORE_SNAP_CORNER_LIST_INL_H_
#else
#define LATVOX_CORE_SNAP_CORNER_LIST_INL_H_
#endif

#include <hwy/highway.h>

#include <array>

#include "core/snap/corner_list.h"
#include "core/snap/triangle_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET != HWY_SCALAR  // which has no vectors of four

namespace hn = hwy::HWY_NAMESPACE;

// The corners, by axis, of kTriangleLanes triangles from place `first` on, a multiple of that, in the order in which
// loading them takes least: lane n holds the one at first + StoredOrder()[n].
HWY_INLINE std::array<Ints3, 3> LoadStored(const CornerList& list, size_t first) {
  const Lanes d;
  std::array<Ints3, 3> v;
  for (size_t n = 0; n < 3; ++n) {
    const int32_t* rows = list.corners[n][first].data();
    v[n] = ColumnsOf({hn::Load(d, rows), hn::Load(d, rows + kTriangleLanes), hn::Load(d, rows + 2 * kTriangleLanes),
                      hn::Load(d, rows + 3 * kTriangleLanes)});
  }
  return v;
}
inline constexpr size_t kStoredRows = kTriangleLanes / 4;  // of a vector: so far apart are neighbours in four lanes
HWY_INLINE Ints StoredOrder() {
  int32_t order[kTriangleLanes];
  for (size_t n = 0; n < kTriangleLanes; ++n) order[n] = static_cast<int32_t>(n % 4 * kStoredRows + n / 4);
  return hn::LoadU(Lanes(), order);
}

// The same in their order.
HWY_INLINE std::array<Ints3, 3> LoadCorners(const CornerList& list, size_t first) {
  const Lanes d;
  int32_t lane_of[kTriangleLanes];
  for (size_t n = 0; n < kTriangleLanes; ++n) {
    lane_of[n] = static_cast<int32_t>(n % kStoredRows * 4 + n / kStoredRows);
  }
  const auto lanes = hn::SetTableIndices(d, lane_of);
  std::array<Ints3, 3> v = LoadStored(list, first);
  if constexpr (kStoredRows > 1) {
    for (Ints3& corner : v) {
      for (Ints& column : corner) column = hn::TableLookupLanes(column, lanes);
    }
  }
  return v;
}

// The same of those at some places: the low bits, below kMost, of each of kTriangleLanes numbers.
template <class Place>
HWY_INLINE std::array<Ints3, 3> LoadCornersAt(const CornerList& list, const Place* places) {
  return LoadCorners([&](size_t corner, size_t n)
                         HWY_ATTR { return list.corners[corner][places[n] & (CornerList::kMost - 1)].data(); });
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
