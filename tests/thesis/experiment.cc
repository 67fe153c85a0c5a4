#include "tests/thesis/experiment.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "core/verify/bcc_indexing.h"

namespace latvox::thesis {

// Eq. 4.3's basis is used as it is: a unit of the world is half an edge of a BCC cell.
std::vector<LatticeCase> LatticeCases() {
  const Lattice cartesian = Lattice::FromBasis({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}).value();
  const Lattice bcc = Lattice::FromBasis({{{2, 0, 0}, {0, 2, 0}, {1, 1, 1}}}).value();
  return {{"cartesian", 2, cartesian, Numbering::kLattice},
          {"cartesian", 1, cartesian, Numbering::kLattice},
          {"cartesian", 0, cartesian, Numbering::kLattice},
          {"bcc", 0, bcc, Numbering::kBcc}};
}

Experiment MakeExperiment(const LatticeCase& lattice_case, int32_t resolution) {
  constexpr Vec3d kOrigin{0.5, 0.5, 0.5};
  const Grid grid{lattice_case.lattice, kOrigin};
  if (lattice_case.numbering == Numbering::kLattice) {
    const Volume volume{lattice_case.numbering, {resolution, resolution, resolution}};
    return {grid, lattice_case.k, volume, static_cast<double>(resolution)};
  }
  const auto cells = static_cast<int32_t>(std::lround(FairBccResolution(resolution)));
  return {grid, lattice_case.k, {lattice_case.numbering, {cells, cells, 2 * cells}}, 2.0 * cells};
}

std::vector<double> Angles() {
  std::mt19937 random(kAngleSeed);
  std::vector<double> angles(72);
  double degrees = 0;
  for (double& angle : angles) {
    angle = degrees + 4 * static_cast<double>(random()) / 4294967296.0;
    degrees += 5;
  }
  return angles;
}

std::array<Vec3d, 4> TetrahedronCorners(double degrees, double side) {
  const double c = std::cos(degrees * M_PI / 180), s = std::sin(degrees * M_PI / 180), leg = side / std::sqrt(2.0);
  std::array<Vec3d, 4> corners{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  for (Vec3d& p : corners) p = Vec3d{p[0], c * p[1] - s * p[2], s * p[1] + c * p[2]} * leg;
  std::array<Vec3d, 4> placed = corners;
  for (size_t m = 0; m < 3; ++m) {
    const auto [low, high] = std::minmax({corners[0][m], corners[1][m], corners[2][m], corners[3][m]});
    for (Vec3d& p : placed) p[m] += (side - low - high) / 2;
  }
  return placed;
}

TriangleMesh RotatedTetrahedron(double degrees, double side) {
  TriangleMesh mesh{{}, {kTetrahedronFaces.begin(), kTetrahedronFaces.end()}};
  for (const Vec3d& p : TetrahedronCorners(degrees, side)) {
    mesh.vertices.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  }
  return mesh;
}

}  // namespace latvox::thesis
