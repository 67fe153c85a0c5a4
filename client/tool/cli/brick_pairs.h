// Two sequences of bricks side by side.
#ifndef LATVOX_CLIENT_TOOL_CLI_BRICK_PAIRS_H_
#define LATVOX_CLIENT_TOOL_CLI_BRICK_PAIRS_H_

#include <span>

#include "latvox/types.h"

namespace latvox::client {

// Calls visit(a, b) with the two bricks of each position, null where one sequence has none. Both sequences, and the
// calls, are in lexicographic order of brick_ijk.
template <class Visit>
void ForEachPair(std::span<const Brick> a, std::span<const Brick> b, const Visit& visit) {
  auto at_a = a.begin(), at_b = b.begin();
  while (at_a != a.end() || at_b != b.end()) {
    const bool take_a = at_b == b.end() || (at_a != a.end() && at_a->brick_ijk <= at_b->brick_ijk);
    const bool take_b = at_a == a.end() || (at_b != b.end() && at_b->brick_ijk <= at_a->brick_ijk);
    visit(take_a ? &*at_a : nullptr, take_b ? &*at_b : nullptr);
    at_a += take_a;
    at_b += take_b;
  }
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_BRICK_PAIRS_H_
