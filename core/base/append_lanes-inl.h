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

// The lanes that a mask selects, to be written one after another, of as many vectors as one likes.
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
      uint8_t set[8];
      hn::StoreMaskBits(d, mask, set);
      alignas(32) static constexpr uint32_t kShifts[8] = {0, 4, 8, 12, 16, 20, 24, 28};
      // A lookup takes the low three bits alone.
      positions_ = hn::Shr(hn::Set(du, kCompressTable[set[0]]), hn::Load(du, kShifts));
    }
#endif
  }

  size_t count() const { return count_; }

  // Writes whole lanes, of which count() mean something. Numbers must be within 0 .. 2^32 - 1.
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

// The same for one vector; returns how many.
template <class D>
HWY_INLINE size_t AppendLanes(D d, hwy::HWY_NAMESPACE::Vec<D> v, hwy::HWY_NAMESPACE::Mask<D> mask, uint32_t* to) {
  const SelectedLanes<D> selected(d, mask);
  selected.Store(v, to);
  return selected.count();
}

#if HWY_TARGET != HWY_SCALAR  // which has no halves
// SelectedLanes of 16 bits.
template <class D>
class SelectedShorts {
 public:
  using Mask = hwy::HWY_NAMESPACE::Mask<D>;
  using V = hwy::HWY_NAMESPACE::Vec<D>;

  HWY_INLINE SelectedShorts(D d, Mask mask) : mask_(mask), count_(hwy::HWY_NAMESPACE::CountTrue(d, mask)) {}

  size_t count() const { return count_; }

  // Writes whole lanes, of which count() mean something.
  HWY_INLINE void Store(V v, uint16_t* to) const {
    namespace hn = hwy::HWY_NAMESPACE;
    const hn::RebindToUnsigned<D> du;
    const auto numbers = hn::BitCast(du, v);
#if HWY_TARGET <= HWY_AVX3_DL  // others compress lanes of 32 bits
    hn::StoreU(hn::Compress(numbers, hn::RebindMask(du, mask_)), du, to);
#else
    const hn::Half<decltype(du)> half;
    const hn::RepartitionToWide<decltype(du)> wide;
    const auto selected = hn::VecFromMask(du, hn::RebindMask(du, mask_));
    const auto append = [&](auto of, auto which) HWY_ATTR {
      const auto mask = hn::Ne(hn::PromoteTo(wide, which), hn::Zero(wide));
      const SelectedLanes<decltype(wide)> some(wide, mask);
      uint32_t lanes[HWY_LANES(uint32_t)] = {};
      some.Store(hn::PromoteTo(wide, of), lanes);
      hn::StoreU(hn::TruncateTo(half, hn::LoadU(wide, lanes)), half, to);
      to += some.count();
    };
    append(hn::LowerHalf(half, numbers), hn::LowerHalf(half, selected));
    append(hn::UpperHalf(half, numbers), hn::UpperHalf(half, selected));
#endif
  }

 private:
  Mask mask_;
  size_t count_;
};
#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
