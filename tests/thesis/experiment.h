// The thesis's experiment (section 5.2): a tetrahedron at many angles, in lattices of equally many points.
#ifndef LATVOX_TESTS_THESIS_EXPERIMENT_H_
#define LATVOX_TESTS_THESIS_EXPERIMENT_H_

#include <array>
#include <string>
#include <vector>

#include "core/lattice/grid.h"
#include "core/mesh/mesh.h"
#include "core/verify/water.h"

namespace latvox::thesis {

// A lattice and the k of its neighborhood. On BCC all k are the same.
struct LatticeCase {
  std::string name;  // "cartesian" or "bcc", as in the tables that are written
  int k;
  Lattice lattice;
  Numbering numbering;
};
std::vector<LatticeCase> LatticeCases();

// A cube in the world with one corner at 0, and the lattice points in it.
struct Experiment {
  Grid grid;
  int k;
  Volume volume;
  double side;  // world units
};

// Returns a volume of D^3 points; on BCC D' x D' x 2D', with D' = D / cbrt(2) rounded (eq. 5.2). The points are as far
// from the cube's low sides as from its high sides.
Experiment MakeExperiment(const LatticeCase& lattice_case, int32_t resolution);

// Returns 0, 5 .. 355 degrees, each plus a fixed jitter of 0 to 4 degrees.
std::vector<double> Angles();
inline constexpr unsigned kAngleSeed = 2006;

// The corners of the tetrahedron below, in doubles, and the corners of its faces.
std::array<Vec3d, 4> TetrahedronCorners(double degrees, double side);
inline constexpr std::array<std::array<uint32_t, 3>, 4> kTetrahedronFaces{{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}};

// Returns the corner of a cube (figure 5.1) turned about the X axis, centered in the cube of the given side. Its
// longest edge is as long as the side (figure 5.5), so it fits at every angle.
TriangleMesh RotatedTetrahedron(double degrees, double side);

}  // namespace latvox::thesis

#endif  // LATVOX_TESTS_THESIS_EXPERIMENT_H_
