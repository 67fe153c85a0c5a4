// Looks up words in memory, one for each lane.
#if defined(LATVOX_CORE_BASE_WORDS_AT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LATVOX_CORE_BASE_WORDS_AT_INL_H_
#undef LATVOX_CORE_BASE_WORDS_AT_INL_H_
#else
#define LATVOX_CORE_BASE_WORDS_AT_INL_H_
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

// The words of 32 bits at `from` + kStep * index bytes, lane by lane.
template <size_t kStep = sizeof(uint32_t)>
HWY_INLINE hwy::HWY_NAMESPACE::Vec<hwy::HWY_NAMESPACE::ScalableTag<uint32_t>> WordsAt(
    const void* from, hwy::HWY_NAMESPACE::Vec<hwy::HWY_NAMESPACE::ScalableTag<uint32_t>> index) {
  namespace hn = hwy::HWY_NAMESPACE;
  static_assert(kStep == 1 || kStep == sizeof(uint32_t));
  using Numbers = hn::ScalableTag<uint32_t>;
  const Numbers d;
#if HWY_TARGET == HWY_AVX2
  // Eight loads: on AMD's Zen 3 a gather, which is microcode there, takes twice as long.
  const auto four = [from](__m128i at) HWY_ATTR {
    const auto low = static_cast<uint64_t>(_mm_cvtsi128_si64(at)),
               high = static_cast<uint64_t>(_mm_extract_epi64(at, 1));
    const auto word = [from](uint64_t n) {
      int32_t bits;
      std::memcpy(&bits, static_cast<const char*>(from) + kStep * n, sizeof(bits));
      return bits;
    };
    __m128i found = _mm_cvtsi32_si128(word(low & UINT32_MAX));
    found = _mm_insert_epi32(found, word(low >> 32), 1);
    found = _mm_insert_epi32(found, word(high & UINT32_MAX), 2);
    return hn::Vec<hn::Half<Numbers>>{_mm_insert_epi32(found, word(high >> 32), 3)};
  };
  const hn::Half<Numbers> half;
  return hn::Combine(d, four(hn::UpperHalf(half, index).raw), four(hn::LowerHalf(half, index).raw));
#else
  const auto* const words = static_cast<const uint32_t*>(from);
  const auto places = hn::BitCast(hn::RebindToSigned<Numbers>(), index);
  if constexpr (kStep == 1) {
    return hn::GatherOffset(d, words, places);
  } else {
    return hn::GatherIndex(d, words, places);
  }
#endif
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#endif
