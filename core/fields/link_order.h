// The order of a lattice point's neighbors in the fields of links.
#ifndef LATVOX_CORE_FIELDS_LINK_ORDER_H_
#define LATVOX_CORE_FIELDS_LINK_ORDER_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "core/base/vec.h"
#include "core/digitize/principal_scan.h"
#include "core/lattice/frame.h"

namespace latvox {

// Returns the k-neighbors of the frames' lattice, ascending lexicographically. So neighbor n is the opposite of
// neighbor size - 1 - n.
inline std::vector<Vec3i> NeighborsOf(const std::vector<Frame>& frames) {
  std::vector<Vec3i> neighbors;
  for (const Frame& frame : frames) {
    neighbors.push_back(frame.q);
    neighbors.push_back(-frame.q);
  }
  std::ranges::sort(neighbors);
  return neighbors;
}

// Where the neighbors along scan frames stand in that order.
struct LinkOrder {
  size_t neighbors;                           // their number
  std::array<size_t, kMaxDirections> places;  // of +q, for each scan frame

  explicit LinkOrder(const std::vector<ScanFrame>& frames) : neighbors(2 * frames.size()), places{} {
    std::vector<Frame> plain;
    for (const ScanFrame& scan : frames) plain.push_back(scan.frame);
    const std::vector<Vec3i> order = NeighborsOf(plain);
    for (size_t n = 0; n < frames.size(); ++n) {
      places[n] = static_cast<size_t>(std::ranges::find(order, frames[n].frame.q) - order.begin());
    }
  }

  size_t Opposite(size_t place) const { return neighbors - 1 - place; }
};

}  // namespace latvox

#endif  // LATVOX_CORE_FIELDS_LINK_ORDER_H_
