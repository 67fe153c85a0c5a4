// Looks many voxels up at once.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/tile/tile_bits.cc"
#include "core/tile/tile_bits.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <type_traits>

#include "core/base/append_lanes-inl.h"
#include "core/base/table_lanes-inl.h"
#include "core/base/words_at-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kLanes = HWY_LANES(uint32_t);
using Numbers = hn::ScalableTag<uint32_t>;

bool IsMember(const uint32_t* words, uint32_t number) {
  return (words[(number & kNumberMask) >> 5] >> (number & 31) & 1) != 0;
}

// Whether bit n of a word is set, lane by lane.
HWY_INLINE hn::Mask<Numbers> TestBits(hn::Vec<Numbers> word, hn::Vec<Numbers> n) {
  const Numbers d;
  return hn::TestBit(hn::Shr(word, hn::And(n, hn::Set(d, 31))), hn::Set(d, 1));
}

// Returns which of the next kLanes numbers are in the set.
HWY_INLINE hn::Mask<Numbers> Members(const uint32_t* words, const uint32_t* numbers) {
  const Numbers d;
  const auto number = hn::And(hn::LoadU(d, numbers), hn::Set(d, kNumberMask));
  return TestBits(WordsAt(words, hn::ShiftRight<5>(number)), number);
}

// Neighbors in a list often share a word of bits, so one change would wait for the other. So the loop does not handle
// neighbors in sequence.
void SetAll(uint32_t* words, std::span<const uint32_t> numbers) {
  constexpr size_t kWays = 4, kBatch = 64;
  const Numbers d;
  const size_t part = numbers.size() / kWays / kBatch * kBatch;
  alignas(64) uint32_t index[kWays][kBatch], bit[kWays][kBatch];
  for (size_t first = 0; first < part; first += kBatch) {
    for (size_t way = 0; way < kWays; ++way) {
      for (size_t n = 0; n < kBatch; n += kLanes) {
        const auto number = hn::LoadU(d, numbers.data() + way * part + first + n);
        hn::Store(hn::ShiftRight<5>(hn::And(number, hn::Set(d, kNumberMask))), d, index[way] + n);
        hn::Store(hn::Shl(hn::Set(d, 1), hn::And(number, hn::Set(d, 31))), d, bit[way] + n);
      }
    }
    for (size_t n = 0; n < kBatch; ++n) {
      for (size_t way = 0; way < kWays; ++way) words[index[way][n]] |= bit[way][n];
    }
  }
  for (const uint32_t number : numbers.subspan(kWays * part)) {
    words[(number & kNumberMask) >> 5] |= 1U << (number & 31);
  }
}

// A branch for vectors without a wanted number would be hard to predict.
void Find(const uint32_t* words, std::span<const uint32_t> numbers, bool in_set, NumberList& positions) {
  const Numbers d;
  const auto unwanted = hn::FirstN(d, in_set ? 0 : kLanes);
  auto position = hn::Iota(d, 0);
  uint32_t* end = positions.end();
  size_t n = 0;
  for (; n + kLanes <= numbers.size(); n += kLanes) {
    end += AppendLanes(d, position, hn::Xor(Members(words, numbers.data() + n), unwanted), end);
    position = hn::Add(position, hn::Set(d, kLanes));
  }
  positions.Grow(static_cast<size_t>(end - positions.end()));
  for (; n < numbers.size(); ++n) {
    if (IsMember(words, numbers[n]) == in_set) positions.Add(static_cast<uint32_t>(n));
  }
}

void Separate(const uint32_t* words, std::span<const uint32_t> numbers, std::span<const uint32_t> others,
              NumberList& in_numbers, NumberList& in_others, NumberList& out) {
  const Numbers d;
  size_t n = 0;
  for (; n + kLanes <= numbers.size(); n += kLanes) {
    const auto members = Members(words, numbers.data() + n);
    const auto number = hn::LoadU(d, numbers.data() + n), other = hn::LoadU(d, others.data() + n);
    const SelectedLanes<Numbers> in(d, members);
    in.Store(number, in_numbers.end());
    in.Store(other, in_others.end());
    in_numbers.Grow(in.count());
    in_others.Grow(in.count());
    out.Grow(AppendLanes(d, other, hn::Not(members), out.end()));
  }
  for (; n < numbers.size(); ++n) {
    if (IsMember(words, numbers[n])) {
      in_numbers.Add(numbers[n]);
      in_others.Add(others[n]);
    } else {
      out.Add(others[n]);
    }
  }
}

NumberRange Range(std::span<const uint32_t> numbers) {
  const Numbers d;
  NumberRange range;
  auto least = hn::Set(d, range.first), most = hn::Zero(d);
  size_t n = 0;
  for (; n + kLanes <= numbers.size(); n += kLanes) {
    const auto number = hn::And(hn::LoadU(d, numbers.data() + n), hn::Set(d, kNumberMask));
    least = hn::Min(least, number);
    most = hn::Max(most, number);
  }
  range = {hn::GetLane(hn::MinOfLanes(d, least)), hn::GetLane(hn::MaxOfLanes(d, most))};
  for (; n < numbers.size(); ++n) range.Add({numbers[n] & kNumberMask, numbers[n] & kNumberMask});
  return range;
}

// A table of a bit for each hash: in registers, or, on AVX2 with too few registers, in the first-level cache.
constexpr bool kTableInRegisters = HWY_TARGET != HWY_AVX2;
constexpr size_t kTableWords = kTableInRegisters ? 4 * kLanes : 1024;
// The place of a number's bit in the table: bits above the number do not affect these bits of the product.
constexpr uint32_t kHashFactor = 0x9E3779B1;
constexpr int kBitShift = kNumberBits - 5, kWordShift = kBitShift - std::countr_zero(kTableWords);
// With more members, too many other numbers share their hashes; a table in the cache saves less than one in registers.
constexpr size_t kFewMembers = kTableWords * 32 / (kTableInRegisters ? 2 : 16);

struct TableInCache {
  const uint32_t* words;
  HWY_INLINE hn::Vec<Numbers> At(hn::Vec<Numbers> places) const {
    return WordsAt(words, hn::And(places, hn::Set(Numbers(), kTableWords - 1)));
  }
};
using HashTable = std::conditional_t<kTableInRegisters, LaneTable<kTableWords>, TableInCache>;

// All numbers are looked up in the table; those found there are looked up in the set.
void FindFew(const uint32_t* words, std::span<const uint32_t> numbers, std::span<const uint32_t> members,
             NumberList& positions) {
  if (members.size() > kFewMembers) return Find(words, numbers, true, positions);
  const Numbers d;
  alignas(64) uint32_t hashed[kTableWords] = {};
  for (const uint32_t member : members) {
    const uint32_t hash = member * kHashFactor;
    hashed[hash >> kWordShift & (kTableWords - 1)] |= 1U << (hash >> kBitShift & 31);
  }
  const HashTable table{hashed};
  const auto likely = [&](hn::Vec<Numbers> number) HWY_ATTR {
    const auto hash = hn::Mul(number, hn::Set(d, kHashFactor));
    const auto word = table.At(hn::ShiftRight<kWordShift>(hash));
    return TestBits(word, hn::ShiftRight<kBitShift>(hash));
  };
  // Some at a time, which stay in the first-level cache.
  constexpr size_t kBatch = 1024;
  static_assert(kBatch % kLanes == 0);
  uint32_t likely_numbers[kBatch + kLanes], likely_positions[kBatch + kLanes];
  for (size_t first = 0; first < numbers.size(); first += kBatch) {
    const size_t end = std::min(first + kBatch, numbers.size()), whole = first + (end - first) / kLanes * kLanes;
    size_t count = 0;
    auto position = hn::Add(hn::Iota(d, 0), hn::Set(d, static_cast<uint32_t>(first)));
    for (size_t n = first; n < whole; n += kLanes) {
      const auto number = hn::LoadU(d, numbers.data() + n);
      const SelectedLanes<Numbers> selected(d, likely(number));
      selected.Store(number, likely_numbers + count);
      selected.Store(position, likely_positions + count);
      count += selected.count();
      position = hn::Add(position, hn::Set(d, kLanes));
    }
    for (size_t n = whole; n < end; ++n, ++count) {
      likely_numbers[count] = numbers[n];
      likely_positions[count] = static_cast<uint32_t>(n);
    }
    std::fill_n(likely_numbers + count, kLanes, 0);
    for (size_t n = 0; n < count; n += kLanes) {
      const auto wanted = hn::And(hn::FirstN(d, count - n), Members(words, likely_numbers + n));
      positions.Grow(AppendLanes(d, hn::LoadU(d, likely_positions + n), wanted, positions.end()));
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

HWY_EXPORT(Range);
HWY_EXPORT(SetAll);
HWY_EXPORT(Find);
HWY_EXPORT(Separate);
HWY_EXPORT(FindFew);

}  // namespace

void NumberList::Enlarge(size_t more) {
  capacity_ = std::max(2 * capacity_, size_ + more + kSlack);
  auto larger = std::make_unique_for_overwrite<uint32_t[]>(capacity_);
  std::copy_n(data_.get(), size_, larger.get());
  data_ = std::move(larger);
}

NumberRange RangeOf(std::span<const uint32_t> numbers) {
  if (!SimdIsScalar()) return HWY_DYNAMIC_DISPATCH(Range)(numbers);
  NumberRange range;
  for (const uint32_t n : numbers) range.Add({n & kNumberMask, n & kNumberMask});
  return range;
}

void TileBits::SetAll(std::span<const uint32_t> numbers) {
  if (!SimdIsScalar()) return HWY_DYNAMIC_DISPATCH(SetAll)(words_.data(), numbers);
  for (const uint32_t number : numbers) Set(number & kNumberMask);
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

void TileBits::Separate(std::span<const uint32_t> numbers, std::span<const uint32_t> others, NumberList& in_numbers,
                        NumberList& in_others, NumberList& out) const {
  for (NumberList* list : {&in_numbers, &in_others, &out}) list->Reserve(numbers.size());
  if (!SimdIsScalar()) {
    return HWY_DYNAMIC_DISPATCH(Separate)(words_.data(), numbers, others, in_numbers, in_others, out);
  }
  for (size_t n = 0; n < numbers.size(); ++n) {
    if (Test(numbers[n] & kNumberMask)) {
      in_numbers.Add(numbers[n]);
      in_others.Add(others[n]);
    } else {
      out.Add(others[n]);
    }
  }
}

void TileBits::FindFew(std::span<const uint32_t> numbers, std::span<const uint32_t> members,
                       NumberList& positions) const {
  if (SimdIsScalar()) return Find(numbers, true, positions);
  positions.Clear();
  if (members.empty()) return;
  positions.Reserve(numbers.size());
  HWY_DYNAMIC_DISPATCH(FindFew)(words_.data(), numbers, members, positions);
}

}  // namespace latvox
#endif  // HWY_ONCE
