// The lattice lines that may meet tiny triangles.
#ifndef LATVOX_CORE_TINY_SIFT_H_
#define LATVOX_CORE_TINY_SIFT_H_

#include <bit>
#include <cstdint>
#include <vector>

#include "core/tiny/line_forms.h"
#include "core/triangles/corner_list.h"

namespace latvox {

// A triangle is tiny if it is near (core/triangles/corner_list.h), and if no more than two integers lie between the
// values of each form at its corners. Then it meets at most four lattice lines of each direction. For the scalar
// kernel, no triangle is tiny.
inline constexpr int kMostIntegers = 2;

// Lines that may meet tiny triangles of a list. Entry n stands for one line along each direction with its bit set in
// directions[n]. Let a be the last integer that is not above all values of the first form at the corners of the
// triangle, and b that of the second. The line is (a - x, b - y), and
//   entries[n] = place in the list | x << kPlaceBits | y << (kPlaceBits + 1).
struct SiftedLines {
  static constexpr int kPlaceBits = std::countr_zero(CornerList::kMost);
  static constexpr size_t kMost = 4 * CornerList::kMost, kSlack = 64;  // whole vectors can be read and written

  size_t size = 0;
  uint16_t entries[kMost + kSlack];
  uint16_t directions[kMost + kSlack];  // after the last entry, those of a vector's lanes are 0
};
static_assert(SiftedLines::kPlaceBits + 2 <= 15, "entries are not negative");
static_assert(kMaxPairs < 16, "each direction has a bit of 16 bits; one bit is the sign");

// Finds all lines that meet tiny triangles of the list, and few others. Appends the numbers of triangles that are not
// tiny to `kept`, in their order.
//   is_tiny   if not null, set for each triangle, by its number; then `kept` gets tiny ones that lines may meet, too
void Sift(const CornerList& triangles, const LineForms& forms, SiftedLines& lines, std::vector<uint32_t>& kept,
          uint8_t* is_tiny);

}  // namespace latvox

#endif  // LATVOX_CORE_TINY_SIFT_H_
