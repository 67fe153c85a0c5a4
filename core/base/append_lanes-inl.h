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
// Entry m holds the positions of the set bits of m, in nibbles. Highway 1.0.3 has the same table as a local variable,
// which gcc 12 copies to the stack for each use.
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

// The lanes that a mask selects, to be written one after another, from any number of vectors.
template <class D>
class SelectedLanes {
 public:
  using Mask = hwy::HWY_NAMESPACE::Mask<D>;
  using V = hwy::HWY_NAMESPACE::Vec<D>;

  HWY_INLINE SelectedLanes(D d, Mask mask) : mask_(mask), count_(hwy::HWY_NAMESPACE::CountTrue(d, mask)) {
    namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET == HWY_AVX2
    if constexpr (kTabled) {
      const hn::RebindToUnsigned<D> du;
      const auto lanes = hn::BitCast(hn::RebindToFloat<D>(), hn::VecFromMask(d, mask));
      const auto set = static_cast<uint32_t>(_mm256_movemask_ps(lanes.raw));
      alignas(32) static constexpr uint32_t kShifts[8] = {0, 4, 8, 12, 16, 20, 24, 28};
      // A lookup uses only the low three bits.
      positions_ = hn::Shr(hn::Set(du, kCompressTable[set]), hn::Load(du, kShifts));
    }
#endif
  }

  size_t count() const { return count_; }

  // Writes whole lanes; the first count() are valid. Numbers must be within 0 .. 2^32 - 1.
  HWY_INLINE void Store(V v, uint32_t* to) const {
    namespace hn = hwy::HWY_NAMESPACE;
    const D d;
    if constexpr (sizeof(T) == 4 && HWY_LANES(T) > 4) {
      const hn::RebindToUnsigned<D> du;
#if HWY_TARGET == HWY_AVX2
      using Indices = decltype(hn::IndicesFromVec(du, positions_));
      hn::StoreU(hn::TableLookupLanes(hn::BitCast(du, v), Indices{positions_.raw}), du, to);
#else
      hn::StoreU(hn::Compress(hn::BitCast(du, v), hn::RebindMask(du, mask_)), du, to);
#endif
    } else {
      alignas(64) T lanes[HWY_LANES(T)];
      hn::Store(v, d, lanes);
      uint64_t set = 0;
      hn::StoreMaskBits(d, mask_, reinterpret_cast<uint8_t*>(&set));
      for (; set != 0; set &= set - 1) *to++ = static_cast<uint32_t>(lanes[std::countr_zero(set)]);
    }
  }

 private:
  using T = hwy::HWY_NAMESPACE::TFromD<D>;
  static constexpr bool kTabled = sizeof(T) == 4;

  Mask mask_;
  size_t count_;
#if HWY_TARGET == HWY_AVX2
  hwy::HWY_NAMESPACE::Vec<hwy::HWY_NAMESPACE::RebindToUnsigned<D>> positions_;
#endif
};

// Does the same for one vector; returns the number of lanes.
template <class D>
HWY_INLINE size_t AppendLanes(D d, hwy::HWY_NAMESPACE::Vec<D> v, hwy::HWY_NAMESPACE::Mask<D> mask, uint32_t* to) {
  const SelectedLanes<D> selected(d, mask);
  selected.Store(v, to);
  return selected.count();
}

#if HWY_TARGET != HWY_SCALAR  // which has no vectors of eight
// Bit n: lane n, with 16 bits, is set.
template <class D>
HWY_INLINE uint64_t BitsOfShorts(D d, hwy::HWY_NAMESPACE::Mask<D> mask) {
  namespace hn = hwy::HWY_NAMESPACE;
#if HWY_TARGET == HWY_AVX2  // StoreMaskBits would take PEXT, which is slow before Zen 3
  if constexpr (hn::MaxLanes(D()) == 16) {
    const __m256i lanes = hn::VecFromMask(d, mask).raw;
    const auto each_twice = static_cast<uint32_t>(_mm256_movemask_epi8(_mm256_packs_epi16(lanes, lanes)));
    return (each_twice & 0xFF) | (each_twice >> 8 & 0xFF00);
  }
#endif
  uint64_t bits = 0;
  hn::StoreMaskBits(d, mask, reinterpret_cast<uint8_t*>(&bits));
  return bits;
}

#if HWY_TARGET <= HWY_AVX3_DL
// SelectedLanes of 16 bits.
template <class D>
class SelectedShorts {
 public:
  using Mask = hwy::HWY_NAMESPACE::Mask<D>;
  using V = hwy::HWY_NAMESPACE::Vec<D>;

  HWY_INLINE SelectedShorts(D d, Mask mask) : mask_(mask), count_(hwy::HWY_NAMESPACE::CountTrue(d, mask)) {}

  size_t count() const { return count_; }

  // Writes whole lanes; the first count() are valid.
  HWY_INLINE void Store(V v, uint16_t* to) const {
    namespace hn = hwy::HWY_NAMESPACE;
    const hn::RebindToUnsigned<D> du;
    hn::StoreU(hn::Compress(hn::BitCast(du, v), hn::RebindMask(du, mask_)), du, to);
  }

 private:
  Mask mask_;
  size_t count_;
};
#else
// Entry m holds the bytes of the lanes with set bits in m, out of eight lanes of 16 bits.
constexpr std::array<std::array<uint8_t, 16>, 256> MakeShortsTable() {
  std::array<std::array<uint8_t, 16>, 256> table{};
  for (uint32_t m = 0; m < 256; ++m) {
    uint32_t at = 0;
    for (uint32_t byte = 0; byte < 16; ++byte) {
      if ((m >> byte / 2 & 1) != 0) table[m][at++] = static_cast<uint8_t>(byte);
    }
  }
  return table;
}
alignas(64) inline constexpr std::array<std::array<uint8_t, 16>, 256> kShortsTable = MakeShortsTable();

// SelectedLanes of 16 bits where no instruction compresses them: eight at a time, by a shuffle of their bytes.
template <class D>
class SelectedShorts {
 public:
  using Mask = hwy::HWY_NAMESPACE::Mask<D>;
  using V = hwy::HWY_NAMESPACE::Vec<D>;

  HWY_INLINE SelectedShorts(D d, Mask mask) : bits_(BitsOfShorts(d, mask)) {}

  size_t count() const { return static_cast<size_t>(std::popcount(bits_)); }

  // Writes whole lanes; the first count() are valid.
  HWY_INLINE void Store(V v, uint16_t* to) const { StoreEights<0, D>(v, to); }

 private:
  // Writes the lanes from 8 * kFirst on; returns the place for the next ones.
  template <size_t kFirst, class DV>
  HWY_INLINE uint16_t* StoreEights(hwy::HWY_NAMESPACE::Vec<DV> v, uint16_t* to) const {
    namespace hn = hwy::HWY_NAMESPACE;
    if constexpr (hn::MaxLanes(DV()) == 8) {
      const hn::RebindToUnsigned<DV> du;
      const uint64_t set = bits_ >> 8 * kFirst & 0xFF;
      const auto bytes = hn::BitCast(du, hn::Load(hn::Repartition<uint8_t, DV>(), kShortsTable[set].data()));
      hn::StoreU(hn::TableLookupBytes(hn::BitCast(du, v), bytes), du, to);
      return to + std::popcount(set);
    } else {
      using Half = hn::Half<DV>;
      to = StoreEights<kFirst, Half>(hn::LowerHalf(Half(), v), to);
      return StoreEights<kFirst + hn::MaxLanes(Half()) / 8, Half>(hn::UpperHalf(Half(), v), to);
    }
  }

  uint64_t bits_;
};
#endif
#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
