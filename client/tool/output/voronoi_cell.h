// The Voronoi cell of a lattice: a voxel's true shape.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_VORONOI_CELL_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_VORONOI_CELL_H_

#include <vector>

#include "latvox/types.h"

namespace latvox::client {

// A facet, which the cell of lattice point 0 shares with that of `neighbor`.
struct CellFace {
  Vec3i neighbor;            // lattice coordinates
  std::vector<int> corners;  // of VoronoiCell, counter-clockwise as seen from outside
};

// The points no farther from lattice point 0 than from any other: a cube on the Cartesian lattice, a truncated
// octahedron on BCC, a rhombic dodecahedron on FCC, a hexagonal prism.
struct VoronoiCell {
  std::vector<Vec3d> corners;  // world, relative to the lattice point
  std::vector<CellFace> faces;
};

// By cutting with the bisectors of all lattice vectors that can matter, in doubles; what is smaller than 1e-9 of the
// cell is left out. Precondition: the basis is not singular.
VoronoiCell VoronoiCellOf(const Basis& basis);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_VORONOI_CELL_H_
