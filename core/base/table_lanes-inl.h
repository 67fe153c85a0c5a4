// A small table of numbers in registers. A lookup costs a fraction of a gather.
#if defined(LATVOX_CORE_BASE_TABLE_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_BASE_TABLE_LANES_INL_H_
#undef LATVOX_CORE_BASE_TABLE_LANES_INL_H_
#else
#define LATVOX_CORE_BASE_TABLE_LANES_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

//   kSize   numbers, a power of two, at least as many as a vector has
template <size_t kSize>
class LaneTable {
 public:
  using Numbers = hwy::HWY_NAMESPACE::ScalableTag<uint32_t>;
  using V = hwy::HWY_NAMESPACE::Vec<Numbers>;

  HWY_INLINE explicit LaneTable(const uint32_t* numbers) {
    for (size_t m = 0; m < kVectors; ++m) table_[m] = hwy::HWY_NAMESPACE::LoadU(Numbers(), numbers + m * kLanes);
  }

  // Returns the numbers at `places`; the bits of places above kSize do not matter.
  HWY_INLINE V At(V places) const {
    namespace hn = hwy::HWY_NAMESPACE;
    const Numbers d;
    const auto lanes = hn::IndicesFromVec(d, hn::And(places, hn::Set(d, kLanes - 1)));
    return Of<0, kVectors>(places, lanes);
  }

 private:
  static constexpr size_t kLanes = HWY_LANES(uint32_t), kVectors = kSize / kLanes;
  static_assert((kSize & (kSize - 1)) == 0 && kVectors > 0);

  template <size_t kFirst, size_t kCount, class Indices>
  HWY_INLINE V Of(V places, Indices lanes) const {
    namespace hn = hwy::HWY_NAMESPACE;
    if constexpr (kCount == 1) {
      return hn::TableLookupLanes(table_[kFirst], lanes);
#if HWY_TARGET <= HWY_AVX3  // Highway 1.0.3 has no lookups in two vectors
    } else if constexpr (kCount == 2) {
      return V{_mm512_permutex2var_epi32(table_[kFirst].raw, places.raw, table_[kFirst + 1].raw)};
#endif
    } else {
      constexpr size_t kHalf = kCount / 2;
      const auto upper = hn::TestBit(places, hn::Set(Numbers(), kHalf * kLanes));
      return hn::IfThenElse(upper, Of<kFirst + kHalf, kHalf>(places, lanes), Of<kFirst, kHalf>(places, lanes));
    }
  }

  V table_[kVectors];
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
