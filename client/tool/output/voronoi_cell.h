// The Voronoi cell of a lattice: the true shape of a voxel.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_VORONOI_CELL_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_VORONOI_CELL_H_

#include <vector>

#include "latvox/types.h"

namespace latvox::client {

// A facet between the cells of lattice point 0 and of `neighbor`.
struct CellFace {
  Vec3i neighbor;            // lattice coordinates
  std::vector<int> corners;  // indices in VoronoiCell, counterclockwise as seen from outside
};

// The points that are at least as near to lattice point 0 as to any other. Examples: a cube on the Cartesian lattice, a
// truncated octahedron on BCC, a rhombic dodecahedron on FCC, a hexagonal prism.
struct VoronoiCell {
  std::vector<Vec3d> corners;  // world, relative to the lattice point
  std::vector<CellFace> faces;
};

// Cuts with the bisectors of all lattice vectors that can matter, in doubles. Omits features below 1e-9 of the cell.
// Precondition: the basis is not singular.
VoronoiCell VoronoiCellOf(const Basis& basis);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_VORONOI_CELL_H_
