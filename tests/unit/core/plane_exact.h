// Shared by the plane's tests: lattices, and conversions to the oracle's types.
#ifndef LATVOX_TESTS_UNIT_CORE_PLANE_EXACT_H_
#define LATVOX_TESTS_UNIT_CORE_PLANE_EXACT_H_

#include <set>
#include <string>
#include <vector>

#include "core/plane/pixelize.h"
#include "tests/unit/core/plane_oracle.h"

namespace latvox {

struct TestPlaneLattice {
  std::string name;
  PlaneLattice lattice;
};

// Points in 1/256 pixel are converted to world coordinates and back exactly on all of them, because snapping removes
// errors far below half a unit.
inline const std::vector<TestPlaneLattice>& PlaneLattices() {
  const auto make = [](const char* name, const Mat2d& basis) {
    return TestPlaneLattice{name, PlaneLattice::FromBasis(basis).value()};
  };
  static const std::vector<TestPlaneLattice> lattices{{"square", PlaneLattice::Named(NamedPlaneLattice::kSquare)},
                                                      {"hexagonal", PlaneLattice::Named(NamedPlaneLattice::kHexagonal)},
                                                      make("nearly hexagonal", {{{8, 0}, {4, 7}}}),
                                                      make("generic", {{{4, 1}, {-1.5, 3}}}),
                                                      make("mirrored rectangle", {{{0, 2}, {1, 0}}}),
                                                      make("square, skew basis", {{{1, 0}, {3, 1}}})};
  return lattices;
}

inline plane_oracle::Int2 ToOracle(const Vec2i& v) { return {v[0], v[1]}; }

inline std::set<plane_oracle::Int2> ToOracle(const std::vector<Vec2i>& pixels) {
  std::set<plane_oracle::Int2> out;
  for (const Vec2i& ij : pixels) out.insert(ToOracle(ij));
  return out;
}

inline std::vector<plane_oracle::Int2> Directions(const PlaneLattice& lattice, int k) {
  std::vector<plane_oracle::Int2> directions;
  for (const PlaneFrame& frame : lattice.frames(k)) directions.push_back(ToOracle(frame.q));
  return directions;
}

inline std::vector<Polyline> ToWorld(const plane_oracle::Drawing& drawing, const PlaneLattice& lattice) {
  std::vector<Polyline> polylines;
  for (const auto& contour : drawing) {
    Polyline polyline{{}, contour.closed};
    for (const auto& p : contour.points) {
      polyline.points.push_back(
          Apply(lattice.basis(), Vec2d{static_cast<double>(p[0]) / 256, static_cast<double>(p[1]) / 256}));
    }
    polylines.push_back(polyline);
  }
  return polylines;
}

inline constexpr LineAlgorithm kAlgorithms[] = {LineAlgorithm::kCrossing, LineAlgorithm::kBruteForce,
                                                LineAlgorithm::kIncremental, LineAlgorithm::kIbanez};

inline PixelizeResult Digitized(const std::vector<Polyline>& polylines, const PlaneGrid& grid, int k, bool minimal,
                                LineAlgorithm algorithm = LineAlgorithm::kCrossing) {
  auto result = Pixelize(polylines, grid, {.separability = k, .minimal = minimal, .algorithm = algorithm});
  EXPECT_TRUE(result.ok()) << result.status();
  return result.ok() ? *std::move(result) : PixelizeResult{};
}

inline PlaneGrid Unscaled(const PlaneLattice& lattice) { return {lattice, {0, 0}}; }

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_CORE_PLANE_EXACT_H_
