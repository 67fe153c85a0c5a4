// A dense set of voxels around one tile, as bits whose numbers are linear in the voxel's coordinates.
#ifndef LATVOX_CORE_TILE_TILE_BITS_H_
#define LATVOX_CORE_TILE_TILE_BITS_H_

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/bytes_of.h"
#include "core/brick/brick.h"

namespace latvox {

// Numbers the voxels of a box around a cube of one or more tiles, called the tile here. A step of the lattice is a
// constant difference of numbers, so a walk along lattice lines needs no coordinates.
//   number = (i - origin[0]) * stride[0] + (j - origin[1]) * stride[1] + (k - origin[2])
// Rows run along k. The tile begins at a whole byte of its rows, and at even coordinates of the box.
struct BitsLayout {
  Vec3i origin;  // local
  Vec3i side;
  Vec3i stride;

  // Reciprocals of stride[0] and stride[1]. Divisions by them are exact for numbers below 2^24 and strides below 2^16:
  // see Quotient.
  std::array<uint64_t, 2> reciprocal;

  // At least `margin` voxels on every side of the tile at `tile_min` (local), `tile_side` voxels a side.
  BitsLayout(const Vec3i& tile_min, const Vec3i& margin, int32_t tile_side = kTileSide) {
    const Vec3i wide{(margin[0] + 1) & ~1, (margin[1] + 1) & ~1, (margin[2] + 7) & ~7};
    origin = tile_min - wide;
    side = wide + wide + Vec3i{tile_side, tile_side, tile_side};
    stride = {side[1] * side[2], side[2], 1};
    for (size_t m = 0; m < 2; ++m) reciprocal[m] = (uint64_t{1} << 44) / static_cast<uint64_t>(stride[m]) + 1;
  }

  // Modulo 2^32, of voxels outside of the box.
  uint32_t NumberOf(const Vec3i& ijk) const { return static_cast<uint32_t>(Dot(ijk - origin, stride)); }
  int32_t StepOf(const Vec3i& q) const { return Dot(q, stride); }
  Vec3i VoxelAt(uint32_t number) const {
    const uint32_t i = Quotient(number, reciprocal[0]), row = Quotient(number, reciprocal[1]);
    return origin + Vec3i{static_cast<int32_t>(i), static_cast<int32_t>(row) - static_cast<int32_t>(i) * side[1],
                          static_cast<int32_t>(number) - static_cast<int32_t>(row) * side[2]};
  }
  // The parity class of a voxel, 0..7. Two k-neighbors never share it, because a neighbor step is never 0 modulo 2.
  static uint32_t ParityClass(const Vec3i& ijk) {
    return static_cast<uint32_t>((ijk[0] & 1) << 2 | (ijk[1] & 1) << 1 | (ijk[2] & 1));
  }
  // The origin and the sides are even, so the indices in the box have the parities of the coordinates.
  uint32_t ParityClass(uint32_t number) const {
    const uint32_t i = Quotient(number, reciprocal[0]), row = Quotient(number, reciprocal[1]);
    return (i & 1) << 2 | (row & 1) << 1 | (number & 1);
  }
  // floor(n / d), where reciprocal = 2^44/d + e, 0 < e <= 1: the error n * e / 2^44 is less than 1/d if n * d < 2^44.
  static uint32_t Quotient(uint32_t n, uint64_t reciprocal) { return static_cast<uint32_t>(n * reciprocal >> 44); }
  // The number of 32-bit words. There are a few more, so that any voxel's bit and the 63 after it can be read.
  size_t Words() const { return static_cast<size_t>(stride[0]) * static_cast<size_t>(side[0]) / 32 + 3; }
};
inline constexpr int kParityClasses = 8;

// Kernels pass numbers with a lane above them.
inline constexpr int kNumberBits = 28;
inline constexpr uint32_t kNumberMask = (1U << kNumberBits) - 1;

// A list of numbers. Kernels append whole lanes at end(), and then set how many of them count.
class NumberList {
 public:
  static constexpr size_t kSlack = 64;  // more than a vector's lanes

  void Reserve(size_t more) {
    if (size_ + more + kSlack > capacity_) Enlarge(more);
  }
  void Add(uint32_t number) { data_[size_++] = number; }  // Precondition: reserved
  uint32_t* data() { return data_.get(); }
  uint32_t* end() { return data_.get() + size_; }
  void Grow(size_t by) { size_ += by; }
  void Clear() { size_ = 0; }
  // Keeps the numbers at some positions, ascending.
  void Keep(std::span<const uint32_t> positions) {
    for (size_t n = 0; n < positions.size(); ++n) data_[n] = data_[positions[n]];
    size_ = positions.size();
  }

  size_t size() const { return size_; }
  size_t Bytes() const { return capacity_ * sizeof(uint32_t); }
  uint32_t operator[](size_t n) const { return data_[n]; }
  std::span<const uint32_t> view() const { return {data_.get(), size_}; }

 private:
  void Enlarge(size_t more);

  size_t size_ = 0, capacity_ = 0;
  std::unique_ptr<uint32_t[]> data_;
};

// Numbers from `first` to `last`; none if first > last.
struct NumberRange {
  uint32_t first = UINT32_MAX, last = 0;

  bool empty() const { return first > last; }
  void Add(const NumberRange& other) {
    first = std::min(first, other.first);
    last = std::max(last, other.last);
  }
};

// The least and the largest of the low kNumberBits of some numbers.
NumberRange RangeOf(std::span<const uint32_t> numbers);

// A set of voxels, one bit each.
class TileBits {
 public:
  explicit TileBits(size_t words) : words_(words) {}

  // Prefetches the word that Test(number) and Set(number) access.
  void Prefetch(uint32_t number) const { __builtin_prefetch(&words_[number >> 5]); }
  bool Test(uint32_t number) const { return words_[number >> 5] >> (number & 31) & 1; }
  void Set(uint32_t number) { words_[number >> 5] |= 1U << (number & 31); }
  void SetAll(std::span<const uint32_t> numbers);  // of their low kNumberBits
  void SetRun(uint32_t first, uint32_t count);     // count > 0
  void Clear(uint32_t number) { words_[number >> 5] &= ~(1U << (number & 31)); }

  // Finds the positions n, ascending, at which the low kNumberBits of numbers[n] are in the set, or are not.
  void Find(std::span<const uint32_t> numbers, bool in_set, NumberList& positions) const;

  // Appends others[n] to `out` where numbers[n] is not in the set. Where it is, appends both to `in_numbers` and
  // `in_others`.
  void Separate(std::span<const uint32_t> numbers, std::span<const uint32_t> others, NumberList& in_numbers,
                NumberList& in_others, NumberList& out) const;

  // Does the same as Find(numbers, true, positions), but faster where the set has few members. `members` has all of
  // them; others and duplicates do no harm.
  void FindFew(std::span<const uint32_t> numbers, std::span<const uint32_t> members, NumberList& positions) const;

  void ClearRange(const NumberRange& range) {
    if (!range.empty()) std::fill(words_.begin() + (range.first >> 5), words_.begin() + (range.last >> 5) + 1, 0);
  }

  size_t Bytes() const { return BytesOf(words_); }
  // Added words are 0.
  void Resize(size_t words) { words_.resize(words); }

  std::vector<uint32_t>& words() { return words_; }
  const std::vector<uint32_t>& words() const { return words_; }

 private:
  std::vector<uint32_t> words_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_TILE_TILE_BITS_H_
