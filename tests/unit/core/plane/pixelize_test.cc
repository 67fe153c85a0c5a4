// Digitized polylines: exactness, covers, minimality, separation.
#include "core/plane/pixelize.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/base/sort.h"
#include "core/base/stop_signal.h"
#include "core/plane/cover.h"
#include "core/plane/thesis_lines.h"
#include "tests/unit/core/plane_exact.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

using plane_oracle::Int2;

TEST(Pixelize, EqualsTheOracleOnAdversarialDrawings) {
  for (const auto& l : PlaneLattices()) {
    for (const auto& [name, drawing] : plane_oracle::AdversarialDrawings(11, Directions(l.lattice, 0))) {
      const auto polylines = ToWorld(drawing, l.lattice);
      for (int k = 0; k < 2; ++k) {
        const auto exact = plane_oracle::Digitize(CurveOf(drawing), Directions(l.lattice, k));
        const auto thinned = plane_oracle::Thinned(exact.pixels, exact.edges);
        ASSERT_EQ(plane_oracle::Tunnels(thinned, exact.edges), 0U);
        ASSERT_EQ(plane_oracle::Redundant(thinned, exact.edges), 0U);
        for (bool minimal : {false, true}) {
          const PixelizeResult result = Digitized(polylines, Unscaled(l.lattice), k, minimal);
          const auto pixels = ToOracle(result.pixels);
          ASSERT_EQ(pixels, minimal ? thinned : exact.pixels) << l.name << " k " << k << " " << name;
          EXPECT_TRUE(std::is_sorted(result.pixels.begin(), result.pixels.end()));
          EXPECT_EQ(result.pixels.size(), pixels.size()) << "no duplicates";
          EXPECT_EQ(result.crossed_links, exact.edges.size());
          EXPECT_EQ(result.tunnels, 0U);
          EXPECT_EQ(result.redundant, minimal ? 0U : plane_oracle::Redundant(exact.pixels, exact.edges)) << name;
        }
      }
    }
  }
}

TEST(Pixelize, CountsTunnelsAndRedundantPixelsOfADamagedSetExactly) {
  std::mt19937 random(17);
  for (const auto& l : PlaneLattices()) {
    const plane_oracle::Drawing drawing{plane_oracle::RandomContour(random, 9, 16, 1500, true)};
    for (int k = 0; k < 2; ++k) {
      const auto snapped = *Snap(ToWorld(drawing, l.lattice), l.lattice, {0, 0});
      const PlaneCrossings crossings = FindCrossings(snapped.segments, l.lattice.frames(k));
      std::vector<Vec2i> damaged;
      for (const Vec2i& ij : crossings.nearer) {
        if (random() % 4 != 0) damaged.push_back(ij);
        if (random() % 4 == 0) damaged.push_back(ij + Vec2i{1, 2});
      }
      SortUnique(damaged, StopSignal());
      plane_oracle::Edges edges;
      for (const PlaneLink& link : crossings.links) edges.insert({ToOracle(link.low), ToOracle(link.high)});
      const auto pixels = ToOracle(damaged);
      PlaneVerdict verdict = Judge(crossings.links, damaged);
      EXPECT_GT(verdict.tunnels, 0U);
      EXPECT_GT(verdict.redundant, 0U);
      EXPECT_EQ(verdict.tunnels, plane_oracle::Tunnels(pixels, edges)) << l.name;
      EXPECT_EQ(verdict.redundant, plane_oracle::Redundant(pixels, edges)) << l.name;
      const uint64_t tunnels = verdict.tunnels;
      Thin(crossings.links, damaged);
      verdict = Judge(crossings.links, damaged);
      EXPECT_EQ(verdict.tunnels, tunnels) << "thinning opens no tunnel";
      EXPECT_EQ(verdict.redundant, 0U) << l.name;
    }
  }
}

TEST(Pixelize, DoesNotDependOnOrderDirectionOrRepetition) {
  for (const auto& l : PlaneLattices()) {
    for (const auto& [name, drawing] : plane_oracle::AdversarialDrawings(12, Directions(l.lattice, 0))) {
      plane_oracle::Drawing turned(drawing.rbegin(), drawing.rend());
      for (auto& contour : turned) std::reverse(contour.points.begin(), contour.points.end());
      turned.push_back(turned.front());
      for (LineAlgorithm algorithm : kAlgorithms) {
        for (int k = 0; k < 2; ++k) {
          const auto one = Digitized(ToWorld(drawing, l.lattice), Unscaled(l.lattice), k, true, algorithm);
          const auto other = Digitized(ToWorld(turned, l.lattice), Unscaled(l.lattice), k, true, algorithm);
          EXPECT_EQ(one.pixels, other.pixels) << l.name << " " << name << " algorithm " << static_cast<int>(algorithm);
          EXPECT_EQ(one.crossed_links, other.crossed_links);
        }
      }
    }
  }
}

// ---- Shapes ---------------------------------------------------------------------------------------------------------

Polyline Circle(const Vec2d& center, double radius, int points) {
  Polyline circle{{}, true};
  for (int n = 0; n < points; ++n) {
    const double angle = 2 * M_PI * n / points;
    circle.points.push_back({center[0] + radius * std::cos(angle), center[1] + radius * std::sin(angle)});
  }
  return circle;
}

// The outline of a star with sharp spikes.
Polyline Star() {
  Polyline star{{}, true};
  for (int n = 0; n < 18; ++n) {
    const double angle = 2 * M_PI * n / 18 + 0.05, radius = n % 2 == 0 ? 1 : 0.15;
    star.points.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  return star;
}

// "OK", bowls and holes, with thin serifs and shared points.
std::vector<Polyline> Text() {
  return {Circle({1, 1}, 1, 60),
          Circle({1, 1}, 0.62, 40),
          {{{2.4, 0},
            {2.4, 2},
            {2.8, 2},
            {2.8, 1.2},
            {3.6, 2},
            {4.1, 2},
            {3.05, 1},
            {4.1, 0},
            {3.6, 0},
            {2.8, 0.8},
            {2.8, 0}},
           true},
          {{{2.3, 0}, {2.9, 0}, {2.9, 0.01}, {2.3, 0.01}}, true}};
}

struct Shape {
  std::string name;
  std::vector<Polyline> outline;
};

std::vector<Shape> Shapes() {
  return {{"circle", {Circle({0.3, -0.2}, 1, 200)}}, {"star", {Star()}}, {"text", Text()}};
}

// Returns whether p is in the even-odd inside of the drawing, in units of 1/256 pixel, shifted by the infinitesimal.
// Counts crossings with the ray from p along +i. Every term is a product of two factors of at most 2^20.
bool Inside(const std::vector<Segment>& segments, const Vec2i& ij) {
  const int64_t x = int64_t{ij[0]} * kLatticeUnit, y = int64_t{ij[1]} * kLatticeUnit;
  bool inside = false;
  for (const Segment& s : segments) {
    Vec<int64_t, 2> a{s.a_lat[0], s.a_lat[1]}, b{s.b_lat[0], s.b_lat[1]};
    if (a[1] > b[1]) std::swap(a, b);
    // The shift moves y up by eps^2: the segment spans p's row iff a_y < y <= b_y.
    if (!(a[1] < y && y <= b[1])) continue;
    // x(row) + eps > x, as a[1] < b[1]: with equality the curve's shift to the right decides.
    if ((a[0] - x) * (b[1] - a[1]) + (b[0] - a[0]) * (y - a[1]) >= 0) inside = !inside;
  }
  return inside;
}

TEST(Pixelize, OutlinesHaveNoTunnelAndNoRedundantPixelOnSquareAndHexagonalLattices) {
  for (const Shape& shape : Shapes()) {
    for (NamedPlaneLattice name : {NamedPlaneLattice::kSquare, NamedPlaneLattice::kHexagonal}) {
      for (uint32_t resolution : {2U, 17U, 256U, 1500U}) {
        const auto grid =
            ResolvePlaneGrid(PlaneLattice::Named(name), {.resolution = resolution}, {}, BoundsOf(shape.outline));
        ASSERT_TRUE(grid.ok()) << grid.status();
        for (int k = 0; k < 2; ++k) {
          const PixelizeResult result = Digitized(shape.outline, *grid, k, true);
          EXPECT_GT(result.crossed_links, 0U);
          EXPECT_EQ(result.tunnels, 0U) << shape.name;
          EXPECT_EQ(result.redundant, 0U) << shape.name;
        }
      }
    }
  }
}

TEST(Pixelize, ClosedCurvesKeepAFloodByKNeighborsOutside) {
  for (const Shape& shape : Shapes()) {
    for (const auto& l : PlaneLattices()) {
      const auto grid = ResolvePlaneGrid(l.lattice, {.resolution = 60}, {}, BoundsOf(shape.outline));
      ASSERT_TRUE(grid.ok()) << grid.status();
      const auto snapped = *Snap(shape.outline, grid->lattice, grid->origin);
      for (int k = 0; k < 2; ++k) {
        std::set<Vec2i> wall;
        Vec2i low{1 << 20, 1 << 20}, high = -low;
        for (const Vec2i& ij : Digitized(shape.outline, *grid, k, true).pixels) {
          wall.insert(ij - snapped.base_ij);
          for (size_t m = 0; m < 2; ++m) {
            low[m] = std::min(low[m], ij[m] - snapped.base_ij[m] - 5);
            high[m] = std::max(high[m], ij[m] - snapped.base_ij[m] + 5);
          }
        }
        std::set<Vec2i> reached{low};
        for (std::vector<Vec2i> front{low}; !front.empty();) {
          const Vec2i z = front.back();
          front.pop_back();
          for (const auto& neighbor : grid->lattice.neighbors()) {
            const Vec2i next = z + neighbor.w;
            if (neighbor.face_dimension < k || wall.contains(next)) continue;
            if (next[0] < low[0] || next[1] < low[1] || next[0] > high[0] || next[1] > high[1]) continue;
            if (reached.insert(next).second) front.push_back(next);
          }
        }
        size_t inside = 0;
        for (int32_t i = low[0]; i <= high[0]; ++i) {
          for (int32_t j = low[1]; j <= high[1]; ++j) {
            if (wall.contains({i, j}) || !Inside(snapped.segments, {i, j})) continue;
            ++inside;
            EXPECT_FALSE(reached.contains({i, j})) << shape.name << " " << l.name << " k " << k << " " << i << "," << j;
          }
        }
        EXPECT_GT(inside, 50U) << shape.name << " " << l.name;
        EXPECT_GT(reached.size(), 500U) << shape.name << " " << l.name;
      }
    }
  }
}

// ---- Grids and errors -----------------------------------------------------------------------------------------------

TEST(ResolvePlaneGrid, MapsTheLongerSideToOnePixelLessThanTheResolution) {
  const PlaneLattice lattice = PlaneLattice::Named(NamedPlaneLattice::kHexagonal);
  const auto grid = ResolvePlaneGrid(lattice, {.resolution = 101}, {}, {{-1, 2}, {4, 12}});
  ASSERT_TRUE(grid.ok());
  EXPECT_NEAR(grid->lattice.pixel_size(), 0.1, 1e-12);
  EXPECT_EQ(grid->origin, (Vec2d{-1, 2}));
  const auto given = ResolvePlaneGrid(lattice, {.pixel_size = 3.0}, Vec2d{7, 8}, {{-1, 2}, {4, 12}});
  ASSERT_TRUE(given.ok());
  EXPECT_NEAR(given->lattice.pixel_size(), 3, 1e-12);
  EXPECT_EQ(given->origin, (Vec2d{7, 8}));
}

TEST(ResolvePlaneGrid, RefusesWhatIsOutOfRangeByName) {
  const auto message = [](const PlaneSampling& sampling, const std::optional<Vec2d>& origin = {},
                          const PlaneBounds& bounds = {{0, 0}, {1, 1}}) {
    return std::string(
        ResolvePlaneGrid(PlaneLattice::Named(NamedPlaneLattice::kSquare), sampling, origin, bounds).status().message());
  };
  EXPECT_EQ(message({.pixel_size = -1.0}), "pixel_size: -1 is not a finite number above 0");
  EXPECT_EQ(message({.resolution = 1}), "resolution: 1 is not within 2 to 65536");
  EXPECT_EQ(message({.resolution = 65537}), "resolution: 65537 is not within 2 to 65536");
  EXPECT_EQ(message({.pixel_size = 1.0, .resolution = 9}), "resolution: not together with pixel_size");
  EXPECT_EQ(message({.resolution = 9}, {}, {{3, 3}, {3, 3}}),
            "resolution: the polylines are a single point; give pixel_size");
  EXPECT_EQ(message({}, Vec2d{0, NAN}), "origin: nan is not a finite number");
  EXPECT_EQ(message({.resolution = 65536}), "");
}

TEST(Pixelize, RefusesBadArgumentsByName) {
  const PlaneGrid grid = Unscaled(PlaneLattice::Named(NamedPlaneLattice::kSquare));
  const std::vector<Polyline> line{{{{0, 0}, {65535, 65535}}}};
  EXPECT_EQ(Pixelize(line, grid, {.separability = 2}).status().message(), "separability: 2 is not 0 or 1");
  EXPECT_EQ(Pixelize({}, grid, {}).status().message(), "polylines: there are none");
  EXPECT_EQ(Pixelize(line, grid, {.algorithm = LineAlgorithm::kBruteForce}).status().message(),
            "algorithm: brute force would test 4295491600 pixels, the limit is 1073741824");
  EXPECT_EQ(Pixelize({{{{0, 0}, {0, 1e6}}}}, grid, {}).status().message(),
            "pixel_size: at 1 the polylines extend over 1000001 pixels on lattice axis j, the limit is 131072");
}

TEST(Pixelize, TakesTheLargestResolutionOnBothNamedLattices) {
  constexpr uint32_t kMost = Dose(65536U, 8192U);
  for (NamedPlaneLattice name : {NamedPlaneLattice::kSquare, NamedPlaneLattice::kHexagonal}) {
    const auto grid = ResolvePlaneGrid(PlaneLattice::Named(name), {.resolution = kMost}, {}, BoundsOf({Star()}));
    ASSERT_TRUE(grid.ok());
    const PixelizeResult result = Digitized({Star()}, *grid, 0, true);
    EXPECT_GT(result.pixels.size(), kMost * 4);
    EXPECT_EQ(result.tunnels, 0U);
    EXPECT_EQ(result.redundant, 0U);
  }
}

}  // namespace
}  // namespace latvox
