// Scan conversion of a triangle in the base plane (thesis section 4.3.1, step 2; figure 4.8).
#ifndef LATVOX_CORE_THESIS_ACTIVE_EDGE_TABLE_H_
#define LATVOX_CORE_THESIS_ACTIVE_EDGE_TABLE_H_

#include <array>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"

namespace latvox {

// The scan lines j of a triangle whose vertices are integer points (i, j), in ascending order. The integer points i in
// first() .. last() of a line lie inside the triangle or on its border. A row may have none (first() > last()).
//
// Because vertices are integer points, an edge advances from row to row by a quotient and a remainder, and nothing is
// rounded.
class ActiveEdgeTable {
 public:
  using Point = Vec<int64_t, 2>;
  // Precondition: the points are not collinear.
  explicit ActiveEdgeTable(const std::array<Point, 3>& vertices);

  bool done() const { return edges_.empty(); }
  int64_t j() const { return j_; }
  int64_t first() const { return first_; }
  int64_t last() const { return last_; }
  void NextRow();

 private:
  struct Edge {
    int64_t first_j, last_j;       // rows
    int64_t i, remainder;          // at row max(j, first_j): i + remainder / rows, 0 <= remainder < rows
    int64_t step, step_remainder;  // from row to row, likewise
    int64_t rows;                  // last_j - first_j
  };
  void Measure();

  std::vector<Edge> edges_;  // those that are not yet passed
  int64_t j_ = 0, first_ = 0, last_ = 0;
};

}  // namespace latvox

#endif  // LATVOX_CORE_THESIS_ACTIVE_EDGE_TABLE_H_
