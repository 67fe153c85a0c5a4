// Looking up many voxels at once.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/tile/tile_bits.cc"
#include "core/tile/tile_bits.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <bit>

#include "core/base/append_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kLanes = HWY_LANES(uint32_t);
using Numbers = hn::ScalableTag<uint32_t>;

// Which of the next kLanes numbers are in the set.
HWY_INLINE hn::Mask<Numbers> Members(const uint32_t* words, const uint32_t* numbers) {
  const Numbers d;
  const auto number = hn::And(hn::LoadU(d, numbers), hn::Set(d, kNumberMask));
  const auto index = hn::BitCast(hn::RebindToSigned<Numbers>(), hn::ShiftRight<5>(number));
  const auto bit = hn::Shr(hn::GatherIndex(d, words, index), hn::And(number, hn::Set(d, 31)));
  return hn::TestBit(bit, hn::Set(d, 1));
}

void Find(const uint32_t* words, std::span<const uint32_t> numbers, bool in_set, NumberList& positions) {
  const Numbers d;
  const auto unwanted = hn::FirstN(d, in_set ? 0 : kLanes);
  const auto step = hn::Set(d, kLanes);
  auto position = hn::Iota(d, 0);
  uint32_t* end = positions.end();
  size_t n = 0;
  for (; n + kLanes <= numbers.size(); n += kLanes) {
    end += AppendLanes(d, position, hn::Xor(Members(words, numbers.data() + n), unwanted), end);
    position = hn::Add(position, step);
  }
  for (; n < numbers.size(); ++n) {
    const uint32_t number = numbers[n] & kNumberMask;
    if (((words[number >> 5] >> (number & 31) & 1) != 0) == in_set) *end++ = static_cast<uint32_t>(n);
  }
  positions.Grow(static_cast<size_t>(end - positions.end()));
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "core/base/simd.h"

namespace latvox {
namespace {

HWY_EXPORT(Find);

}  // namespace

void NumberList::Enlarge(size_t more) {
  capacity_ = std::max(2 * capacity_, size_ + more + kSlack);
  auto larger = std::make_unique_for_overwrite<uint32_t[]>(capacity_);
  std::copy_n(data_.get(), size_, larger.get());
  data_ = std::move(larger);
}

void TileBits::SetRun(uint32_t first, uint32_t count) {
  const uint32_t last = first + count - 1;
  const uint32_t from = ~0U << (first & 31), to = ~0U >> (31 - (last & 31));
  if (first >> 5 == last >> 5) {
    words_[first >> 5] |= from & to;
    return;
  }
  words_[first >> 5] |= from;
  for (uint32_t n = (first >> 5) + 1; n < last >> 5; ++n) words_[n] = ~0U;
  words_[last >> 5] |= to;
}

void TileBits::Find(std::span<const uint32_t> numbers, bool in_set, NumberList& positions) const {
  positions.Clear();
  positions.Reserve(numbers.size());
  if (!SimdIsScalar()) return HWY_DYNAMIC_DISPATCH(Find)(words_.data(), numbers, in_set, positions);
  for (size_t n = 0; n < numbers.size(); ++n) {
    if (Test(numbers[n] & kNumberMask) == in_set) positions.Add(static_cast<uint32_t>(n));
  }
}

}  // namespace latvox
#endif  // HWY_ONCE
