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

// Calls take(n, mask) for position after position, and rest(n) for the last few.
template <class Take, class Rest>
HWY_INLINE void ForAll(const uint32_t* words, std::span<const uint32_t> numbers, Take&& take, Rest&& rest) {
  size_t n = 0;
  for (; n + kLanes <= numbers.size(); n += kLanes) take(n, Members(words, numbers.data() + n));
  for (; n < numbers.size(); ++n) {
    const uint32_t number = numbers[n] & kNumberMask;
    rest(n, (words[number >> 5] >> (number & 31) & 1) != 0);
  }
}

void Find(const uint32_t* words, std::span<const uint32_t> numbers, bool in_set, NumberList& positions) {
  const Numbers d;
  const auto unwanted = hn::FirstN(d, in_set ? 0 : kLanes);
  ForAll(
      words, numbers,
      [&](size_t n, hn::Mask<Numbers> members) HWY_ATTR {
        const auto some = hn::Xor(members, unwanted);
        positions.Grow(AppendLanes(d, hn::Iota(d, static_cast<uint32_t>(n)), some, positions.end()));
      },
      [&](size_t n, bool member) HWY_ATTR {
        if (member == in_set) positions.Add(static_cast<uint32_t>(n));
      });
}

void Split(const uint32_t* words, std::span<const uint32_t> numbers, const uint32_t* partners, NumberList& in,
           NumberList& out) {
  const Numbers d;
  ForAll(
      words, numbers,
      [&](size_t n, hn::Mask<Numbers> members) HWY_ATTR {
        in.Grow(AppendLanes(d, hn::Iota(d, static_cast<uint32_t>(n)), members, in.end()));
        out.Grow(AppendLanes(d, hn::LoadU(d, partners + n), hn::Not(members), out.end()));
      },
      [&](size_t n, bool member) HWY_ATTR { member ? in.Add(static_cast<uint32_t>(n)) : out.Add(partners[n]); });
}

// Blocks of lanes without a member are passed over.
void ListOutside(const std::vector<uint32_t>& words, const std::vector<uint32_t>& others, NumberList& numbers) {
  const Numbers d;
  for (size_t n = 0; n < words.size(); n += kLanes) {
    const size_t end = std::min(n + kLanes, words.size());
    if (end == n + kLanes) {
      const auto some = hn::AndNot(hn::LoadU(d, others.data() + n), hn::LoadU(d, words.data() + n));
      if (hn::AllTrue(d, hn::Eq(some, hn::Zero(d)))) continue;
    }
    for (size_t m = n; m < end; ++m) {
      uint32_t bits = words[m] & ~others[m];
      if (bits == 0) continue;
      numbers.Reserve(32);
      for (; bits != 0; bits &= bits - 1) {
        numbers.Add(static_cast<uint32_t>(m * 32) + static_cast<uint32_t>(std::countr_zero(bits)));
      }
    }
  }
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
HWY_EXPORT(Split);
HWY_EXPORT(ListOutside);

}  // namespace

void NumberList::Enlarge(size_t more) {
  capacity_ = std::max(2 * capacity_, size_ + more + kSlack);
  auto larger = std::make_unique_for_overwrite<uint32_t[]>(capacity_);
  std::copy_n(data_.get(), size_, larger.get());
  data_ = std::move(larger);
}

void TileBits::SetDifference(const TileBits& all, const TileBits& some) {
  words_.resize(all.words_.size());
  for (size_t n = 0; n < words_.size(); ++n) words_[n] = all.words_[n] & ~some.words_[n];
}

void TileBits::ListOutside(const TileBits& other, NumberList& numbers) const {
  HWY_DYNAMIC_DISPATCH(ListOutside)(words_, other.words_, numbers);
}

void TileBits::Find(std::span<const uint32_t> numbers, bool in_set, NumberList& positions) const {
  positions.Clear();
  positions.Reserve(numbers.size());
  if (!SimdIsScalar()) return HWY_DYNAMIC_DISPATCH(Find)(words_.data(), numbers, in_set, positions);
  for (size_t n = 0; n < numbers.size(); ++n) {
    if (Test(numbers[n] & kNumberMask) == in_set) positions.Add(static_cast<uint32_t>(n));
  }
}

void TileBits::Split(std::span<const uint32_t> numbers, std::span<const uint32_t> partners, NumberList& in,
                     NumberList& out) const {
  for (NumberList* list : {&in, &out}) {
    list->Clear();
    list->Reserve(numbers.size());
  }
  if (!SimdIsScalar()) return HWY_DYNAMIC_DISPATCH(Split)(words_.data(), numbers, partners.data(), in, out);
  for (size_t n = 0; n < numbers.size(); ++n) {
    Test(numbers[n] & kNumberMask) ? in.Add(static_cast<uint32_t>(n)) : out.Add(partners[n]);
  }
}

}  // namespace latvox
#endif  // HWY_ONCE
