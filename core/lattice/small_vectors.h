// Integer vectors with small entries.
#ifndef LATVOX_CORE_LATTICE_SMALL_VECTORS_H_
#define LATVOX_CORE_LATTICE_SMALL_VECTORS_H_

#include <cstdint>
#include <cstdlib>

#include "core/base/vec.h"

namespace latvox {

template <size_t D>
int AbsoluteSum(const Vec<int32_t, D>& v) {
  int sum = 0;
  for (const int32_t x : v) sum += std::abs(x);
  return sum;
}

// Calls f for every vector with entries in -bound..bound, in lexicographic order.
template <size_t D, class F>
void ForEachInCube(int32_t bound, F f) {
  Vec<int32_t, D> v;
  v.fill(-bound);
  while (true) {
    f(v);
    size_t m = D;
    while (m > 0 && v[m - 1] == bound) v[--m] = -bound;
    if (m == 0) return;
    ++v[m - 1];
  }
}

}  // namespace latvox

#endif  // LATVOX_CORE_LATTICE_SMALL_VECTORS_H_
