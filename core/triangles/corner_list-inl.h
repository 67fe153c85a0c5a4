// Reads corners of a list into lanes, and writes them there.
#if defined(LATVOX_CORE_TRIANGLES_CORNER_LIST_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_TRIANGLES_CORNER_LIST_INL_H_
#undef LATVOX_CORE_TRIANGLES_CORNER_LIST_INL_H_
#else
#define LATVOX_CORE_TRIANGLES_CORNER_LIST_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <bit>

#include "core/base/append_lanes-inl.h"
#include "core/triangles/corner_list.h"
#include "core/triangles/triangle_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET != HWY_SCALAR  // which has no vectors of four

namespace hn = hwy::HWY_NAMESPACE;

// As many triangles as a vector of D has lanes: 16 bits each, eight or more.
template <class D>
using ShortCorners = std::array<std::array<hn::Vec<D>, 3>, 3>;  // by axis

// Within each eight lanes, rows become columns: the first three, and those from the fifth to the seventh on.
template <class D, class V = hn::Vec<D>>
HWY_INLINE void ColumnsOf(D d, const std::array<V, 8>& rows, std::array<V, 3>& first, std::array<V, 3>& second) {
  const hn::RepartitionToWide<D> d32;
  const hn::RepartitionToWide<decltype(d32)> d64;
  // The content of four rows in lanes 0, 1; 2, 3; 4, 5; 6, 7.
  const auto four = [&](size_t n) HWY_ATTR {
    const auto low_01 = hn::BitCast(d32, hn::InterleaveLower(d, rows[n], rows[n + 1]));
    const auto low_23 = hn::BitCast(d32, hn::InterleaveLower(d, rows[n + 2], rows[n + 3]));
    const auto high_01 = hn::BitCast(d32, hn::InterleaveUpper(d, rows[n], rows[n + 1]));
    const auto high_23 = hn::BitCast(d32, hn::InterleaveUpper(d, rows[n + 2], rows[n + 3]));
    return std::array{hn::BitCast(d64, hn::InterleaveLower(d32, low_01, low_23)),
                      hn::BitCast(d64, hn::InterleaveUpper(d32, low_01, low_23)),
                      hn::BitCast(d64, hn::InterleaveLower(d32, high_01, high_23)),
                      hn::BitCast(d64, hn::InterleaveUpper(d32, high_01, high_23))};
  };
  const auto first_rows = four(0), last_rows = four(4);
  const auto three = [&](size_t n) HWY_ATTR {
    return std::array<V, 3>{hn::BitCast(d, hn::InterleaveLower(d64, first_rows[n], last_rows[n])),
                            hn::BitCast(d, hn::InterleaveUpper(d64, first_rows[n], last_rows[n])),
                            hn::BitCast(d, hn::InterleaveLower(d64, first_rows[n + 1], last_rows[n + 1]))};
  };
  first = three(0);
  second = three(2);
}

// The corners of the triangles from place `first` on, in StoredOrder, the order that is cheapest to load. Also returns
// the voxels of their first corners, as in the list.
template <class D>
HWY_INLINE ShortCorners<D> LoadStored(D d, const CornerList& list, size_t first, std::array<hn::Vec<D>, 3>& voxel) {
  const auto rows = [&](const CornerList::Row* of) HWY_ATTR {
    std::array<hn::Vec<D>, 8> loaded;
    for (size_t n = 0; n < 8; ++n) loaded[n] = hn::LoadU(d, of[first + n * (hn::MaxLanes(D()) / 8)].data());
    return loaded;
  };
  ShortCorners<D> v;
  ColumnsOf(d, rows(list.first_two), v[0], v[1]);
  ColumnsOf(d, rows(list.third_and_voxel), v[2], voxel);
  return v;
}

template <class D>
HWY_INLINE ShortCorners<D> LoadStored(D d, const CornerList& list, size_t first) {
  std::array<hn::Vec<D>, 3> voxel;
  return LoadStored(d, list, first, voxel);
}

// Lane n holds the triangle at first + StoredOrder()[n].
template <class D>
HWY_INLINE hn::Vec<D> StoredOrder(D d) {
  constexpr size_t kLanes = hn::MaxLanes(D());
  int16_t order[kLanes];
  for (size_t n = 0; n < kLanes; ++n) order[n] = static_cast<int16_t>(n % 8 * (kLanes / 8) + n / 8);
  return hn::LoadU(d, order);
}

// Converts a mask of vectors in that order to bits in the order of places.
template <class D>
class LaneOrder {
 public:
  HWY_INLINE LaneOrder(D d, hn::Vec<D> place_of) { hn::StoreU(place_of, d, place_of_); }

  HWY_INLINE uint64_t operator()(hn::Mask<D> mask) const {
    uint64_t lanes = BitsOfShorts(D(), mask), places = 0;
    for (; lanes != 0; lanes &= lanes - 1) places |= uint64_t{1} << place_of_[std::countr_zero(lanes)];
    return places;
  }

 private:
  static_assert(hn::MaxLanes(D()) <= 64);
  int16_t place_of_[hn::MaxLanes(D())];
};

// Does the same for the triangles at some places: the low bits, below kMost, of as many numbers. Also returns the
// voxels of their first corners, as in the list.
template <class D>
HWY_INLINE ShortCorners<D> LoadCornersAt(D d, const CornerList& list, const uint16_t* places,
                                         std::array<hn::Vec<D>, 3>& voxel) {
  const auto rows = [&](const CornerList::Row* of) HWY_ATTR {
    std::array<hn::Vec<D>, 8> loaded;
    for (size_t n = 0; n < 8; ++n) {
      loaded[n] =
          LoadRows(d, [&](size_t m) HWY_ATTR { return of[places[8 * m + n] & (CornerList::kMost - 1)].data(); });
    }
    return loaded;
  };
  ShortCorners<D> v;
  ColumnsOf(d, rows(list.first_two), v[0], v[1]);
  ColumnsOf(d, rows(list.third_and_voxel), v[2], voxel);
  return v;
}

// Returns which triangles are near: see CornerList.
template <class D>
HWY_INLINE hn::Mask<D> AreNear(D d, const ShortCorners<D>& v) {
  auto off = hn::Zero(d);
  for (size_t n = 1; n < 3; ++n) {  // the first corner is near
    for (const auto& x : v[n]) off = hn::Or(off, hn::Add(x, hn::Set(d, CornerList::kNear)));
  }
  return hn::Eq(hn::And(off, hn::Set(d, static_cast<int16_t>(-2 * CornerList::kNear))), hn::Zero(d));
}

// Writes the corners of as many triangles as there are blocks of 128 bits, at `place` and behind. Each block holds x,
// y, z and an arbitrary number.
//   origin   of the list, as such blocks
template <class D, class V = hn::Vec<D>>
HWY_INLINE void StoreCorners(D d, V a, V b, V c, V origin, CornerList& list, size_t place) {
  const hn::RepartitionToNarrow<D> narrow;
  const V fraction = hn::Set(d, kLatticeUnit - 1), low = hn::AndNot(fraction, a);
  const V voxel = hn::Add(hn::Sub(hn::ShiftRight<kSubvoxelBits>(a), origin), hn::Set(d, CornerList::kFirstVoxel));
  // Saturates, and interleaves block by block.
  const auto two = hn::ReorderDemote2To(narrow, hn::And(fraction, a), hn::Sub(b, low));
  const auto others = hn::ReorderDemote2To(narrow, hn::Sub(c, low), voxel);
  hn::StoreU(two, narrow, list.first_two[place].data());
  hn::StoreU(others, narrow, list.third_and_voxel[place].data());
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
