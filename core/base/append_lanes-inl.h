// Appends the lanes that a mask selects to an array of numbers.
#if defined(LATVOX_CORE_BASE_APPEND_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_BASE_APPEND_LANES_INL_H_
#undef LATVOX_CORE_BASE_APPEND_LANES_INL_H_
#else
#define LATVOX_CORE_BASE_APPEND_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <array>
#include <bit>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_AVX2
// Entry m holds the positions of the set bits of m, in nibbles. Highway 1.0.3 has the same table, but as a local
// variable, which gcc 12 copies to the stack for each use.
constexpr std::array<uint32_t, 256> MakeCompressTable() {
  std::array<uint32_t, 256> table{};
  for (uint32_t m = 0; m < 256; ++m) {
    uint32_t at = 0;
    for (uint32_t bit = 0; bit < 8; ++bit) {
      if ((m >> bit & 1) != 0) table[m] |= bit << (4 * at++);
    }
  }
  return table;
}
inline constexpr std::array<uint32_t, 256> kCompressTable = MakeCompressTable();
#endif

// Writes whole lanes at `to`; returns how many of them count. Numbers must be within 0 .. 2^32 - 1.
template <class D, class V = hwy::HWY_NAMESPACE::Vec<D>>
HWY_INLINE size_t AppendLanes(D d, V v, hwy::HWY_NAMESPACE::Mask<D> mask, uint32_t* to) {
  namespace hn = hwy::HWY_NAMESPACE;
  using T = hn::TFromD<D>;
  if constexpr (sizeof(T) == 4 && HWY_LANES(T) > 4) {
    const hn::RebindToUnsigned<D> du;
    const auto bits = hn::BitCast(du, v);
#if HWY_TARGET == HWY_AVX2
    uint8_t set[8];
    hn::StoreMaskBits(d, mask, set);
    alignas(32) static constexpr uint32_t kShifts[8] = {0, 4, 8, 12, 16, 20, 24, 28};
    const auto nibbles = hn::Shr(hn::Set(du, kCompressTable[set[0]]), hn::Load(du, kShifts));
    hn::StoreU(hn::TableLookupLanes(bits, hn::IndicesFromVec(du, hn::And(nibbles, hn::Set(du, 7)))), du, to);
#else
    hn::StoreU(hn::Compress(bits, hn::RebindMask(du, mask)), du, to);
#endif
    return hn::CountTrue(d, mask);
  } else {
    alignas(64) T lanes[HWY_LANES(T)];
    hn::Store(v, d, lanes);
    uint64_t set = 0;
    hn::StoreMaskBits(d, mask, reinterpret_cast<uint8_t*>(&set));
    size_t count = 0;
    for (; set != 0; set &= set - 1) to[count++] = static_cast<uint32_t>(lanes[std::countr_zero(set)]);
    return count;
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
