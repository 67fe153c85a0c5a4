// The points of a finer lattice that belong to a Voronoi cell.
#ifndef LATVOX_CORE_LATTICE_CELL_POINTS_H_
#define LATVOX_CORE_LATTICE_CELL_POINTS_H_

#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/lattice/integer_cell.h"

namespace latvox {

// Points of the lattice that is n times as fine have integer coordinates in steps of 1/n. The lattice point z is the
// finer point n z. Each finer point belongs to one cell, so each cell has n^3 of them.
//
// Ties. A finer point on the border of cells belongs to the one that contains it after all borders are shifted by the
// infinitesimal (e, e^2, e^3), as surfaces are (core/digitize/crossing.h). So a mesh along a cell's border contains all
// points of the cell and no others.
struct CellPoints {
  // Consecutive points along k. A cell is convex, so it has one run for each pair of i and j. Along a lattice vector,
  // it is no longer than that vector, so a run has at most n points.
  struct Run {
    Vec3i first;  // relative to the cell's lattice point
    int32_t count;
  };

  int32_t n;
  std::vector<Run> runs;  // in lexicographic order
  Vec3i low, high;        // the box of all points, both ends included; it contains 0

  int32_t size() const { return n * n * n; }
};

// Precondition: 1 <= n <= 2^8.
CellPoints PointsOf(const IntegerCell& cell, int32_t n);

}  // namespace latvox

#endif  // LATVOX_CORE_LATTICE_CELL_POINTS_H_
