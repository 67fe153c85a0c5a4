#include "core/thesis/active_edge_table.h"

#include <algorithm>
#include <limits>

#include "core/digitize/crossing.h"

namespace latvox {

// A horizontal edge needs no entry, because its ends are the ends of the other two.
ActiveEdgeTable::ActiveEdgeTable(const std::array<Point, 3>& vertices) {
  for (size_t n = 0; n < 3; ++n) {
    Point low = vertices[n], high = vertices[(n + 1) % 3];
    if (low[1] == high[1]) continue;
    if (low[1] > high[1]) std::swap(low, high);
    const int64_t rows = high[1] - low[1], width = high[0] - low[0];
    const int64_t step = crossing_internal::FloorDiv(width, rows);
    edges_.push_back({low[1], high[1], low[0], 0, step, width - step * rows, rows});
  }
  j_ = std::min({vertices[0][1], vertices[1][1], vertices[2][1]});
  Measure();
}

void ActiveEdgeTable::NextRow() {
  ++j_;
  std::erase_if(edges_, [this](const Edge& edge) { return edge.last_j < j_; });
  for (Edge& edge : edges_) {
    if (j_ <= edge.first_j) continue;
    edge.i += edge.step;
    edge.remainder += edge.step_remainder;
    if (edge.remainder >= edge.rows) {
      edge.remainder -= edge.rows;
      ++edge.i;
    }
  }
  Measure();
}

// The row of a convex shape is one interval: from the least of its edges, rounded up, to the greatest, rounded down.
void ActiveEdgeTable::Measure() {
  first_ = std::numeric_limits<int64_t>::max();
  last_ = std::numeric_limits<int64_t>::min();
  for (const Edge& edge : edges_) {
    if (j_ < edge.first_j) continue;
    first_ = std::min(first_, edge.i + (edge.remainder > 0 ? 1 : 0));
    last_ = std::max(last_, edge.i);
  }
}

}  // namespace latvox
