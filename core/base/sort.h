// Sorting that can be cancelled.
#ifndef LATVOX_CORE_BASE_SORT_H_
#define LATVOX_CORE_BASE_SORT_H_

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "core/base/stop_signal.h"

namespace latvox {

// A piece of an array; any step over it takes at most some milliseconds.
inline constexpr size_t kSortedPiece = size_t{1} << 16;

// Merges two sorted ranges, one after the other, like std::inplace_merge, which cannot be cancelled. Once cancelled,
// leaves all their elements in any order.
//   left   memory
template <class T, class Less>
void MergeAdjacent(std::span<T> first, std::span<T> second, std::vector<T>& left, StopSignal stop, const Less& less) {
  if (!less(second.front(), first.back())) return;
  left.clear();
  left.reserve(first.size());
  for (size_t n = 0; n < first.size(); n += kSortedPiece) {
    if (stop.Stopped()) return;
    const std::span<T> piece = first.subspan(n, std::min(kSortedPiece, first.size() - n));
    left.insert(left.end(), piece.begin(), piece.end());
  }
  T* out = first.data();
  const T *a = left.data(), *const a_end = a + left.size();
  const T *b = second.data(), *const b_end = b + second.size();
  while (a != a_end && b != b_end && !stop.Stopped()) {
    const size_t steps = std::min({kSortedPiece, static_cast<size_t>(a_end - a), static_cast<size_t>(b_end - b)});
    for (size_t n = 0; n < steps; ++n) *out++ = less(*b, *a) ? *b++ : *a++;
  }
  std::copy(a, a_end, out);  // there is room for them up to b
}

// Sorts, by std::sort unless there are many elements. Returns soon once cancelled, with the elements in any order.
template <class T, class Less = std::less<T>>
void Sort(std::span<T> elements, StopSignal stop, const Less& less = {}) {
  const auto part = [&](size_t begin, size_t end) {
    return elements.subspan(begin, std::min(end, elements.size()) - begin);
  };
  for (size_t n = 0; n < elements.size() && !stop.Stopped(); n += kSortedPiece) {
    const std::span<T> piece = part(n, n + kSortedPiece);
    std::sort(piece.begin(), piece.end(), less);
  }
  std::vector<T> left;
  for (size_t width = kSortedPiece; width < elements.size(); width *= 2) {
    for (size_t n = 0; n + width < elements.size() && !stop.Stopped(); n += 2 * width) {
      MergeAdjacent(part(n, n + width), part(n + width, n + 2 * width), left, stop, less);
    }
  }
}

template <class T, class Less = std::less<T>>
void Sort(std::vector<T>& elements, StopSignal stop, const Less& less = {}) {
  Sort(std::span(elements), stop, less);
}

// Does the same, and removes duplicates.
template <class T>
void SortUnique(std::vector<T>& elements, StopSignal stop) {
  Sort(elements, stop);
  elements.erase(std::unique(elements.begin(), elements.end()), elements.end());
}

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_SORT_H_
