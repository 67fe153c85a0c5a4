// Sorting that can be cut short.
#ifndef LATVOX_CORE_BASE_SORT_H_
#define LATVOX_CORE_BASE_SORT_H_

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <vector>

namespace latvox {

// Sorts, by std::sort unless there are many. Returns soon once cancelled, with the elements in any order.
template <class T, class Less = std::less<T>>
void Sort(std::vector<T>& elements, const std::atomic<bool>& cancelled, const Less& less = {}) {
  constexpr size_t kPiece = size_t{1} << 16;  // takes some milliseconds
  const auto at = [&](size_t n) { return elements.begin() + static_cast<ptrdiff_t>(std::min(n, elements.size())); };
  for (size_t n = 0; n < elements.size() && !cancelled; n += kPiece) std::sort(at(n), at(n + kPiece), less);
  for (size_t width = kPiece; width < elements.size(); width *= 2) {
    for (size_t n = 0; n + width < elements.size() && !cancelled; n += 2 * width) {
      std::inplace_merge(at(n), at(n + width), at(n + 2 * width), less);
    }
  }
}

// The same, without duplicates.
template <class T>
void SortUnique(std::vector<T>& elements, const std::atomic<bool>& cancelled) {
  Sort(elements, cancelled);
  elements.erase(std::unique(elements.begin(), elements.end()), elements.end());
}

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_SORT_H_
