// Packs a voxel's three coordinates and a number of lines into one integer. So one addition advances all four, and one
// test finds whether any is out of bounds.
#if defined(LATVOX_CORE_SCAN_PACKED_COUNTER_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_SCAN_PACKED_COUNTER_INL_H_
#undef LATVOX_CORE_SCAN_PACKED_COUNTER_INL_H_
#else
#define LATVOX_CORE_SCAN_PACKED_COUNTER_INL_H_
#endif

#include <hwy/highway.h>

#include "core/triangles/triangle_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET != HWY_SCALAR

namespace hn = hwy::HWY_NAMESPACE;

// A counter is i + j * 2^8 + k * 2^16 + lines * 2^24, modulo 2^32. It holds the coordinates of a line's voxel, counted
// from the lowest wanted one, and the number of lines that follow in the row. The top bit of each of the four fields is
// its sign.
//
// Claim: some field of a counter has its sign set iff one of the four numbers is negative, if these fit their fields:
// coordinates -128 .. 127, lines -128 .. 127. Proof: take the lowest negative number, if there is one. The fields
// below it hold numbers that are not negative, so nothing is borrowed from its field, which holds the number itself,
// and has its sign set. If no number is negative, nothing is borrowed at all, and no sign is set. (A negative number
// borrows 1 from the field above, whose sign may then be wrong. By then the answer is given.)
//
// A counter is inside iff neither it nor `limit` - counter has a sign set. `limit` holds the largest wanted
// coordinates, and kMostLines - 1 lines. So the coordinates c have 0 <= c <= limit, and lines follow. If some c is
// negative, the counter has a sign set, and it does not matter that limit - c may not fit.
//
// Lanes with a finished row go on until the longest row ends. There the number of lines is negative, and coordinates
// may be up to 2 * kMostCoordinate in size and not fit. But then the three lower fields together are less than 2^24 in
// size, so the whole counter is negative: its top bit, the sign of the lines, is set.
class PackedCounter {
 public:
  static constexpr int32_t kMostCoordinate = 127, kMostLines = 56;

  // The counter of a sum is the sum of the counters.
  static HWY_INLINE Ints Coordinates(const Ints3& ijk) {
    return hn::Add(hn::Add(ijk[0], hn::ShiftLeft<kBits>(ijk[1])), hn::ShiftLeft<2 * kBits>(ijk[2]));
  }
  static HWY_INLINE Ints Lines(Ints lines) { return hn::ShiftLeft<kLinesShift>(lines); }

  // A counter that is outside, and stays outside while up to kMostLines steps with one line less each are added.
  static HWY_INLINE Ints None() { return Fill(-1); }

  //   limit   the largest wanted coordinates
  HWY_INLINE explicit PackedCounter(const Ints3& limit)
      : limit_(hn::Add(Coordinates(limit), Fill((kMostLines - 1) << kLinesShift))) {}

  // Any of kSigns is set where the counter is outside.
  HWY_INLINE Ints Signs(Ints counter) const { return hn::Or(counter, hn::Sub(limit_, counter)); }
  static constexpr uint32_t kSigns = 0x80808080;

 private:
  static constexpr int kBits = 8, kLinesShift = 3 * kBits;
  static_assert(kMostCoordinate < 1 << (kBits - 1) && kMostLines <= 1 << (31 - kLinesShift));
  static_assert(2 * kMostCoordinate * (1 + (1 << kBits) + (1 << 2 * kBits)) < 1 << kLinesShift);

  Ints limit_;
};

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
