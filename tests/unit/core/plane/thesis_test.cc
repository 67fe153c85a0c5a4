// The thesis's algorithms in the plane: lines, discs, and the redundant pixels that they leave.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/base/sort.h"
#include "core/base/stop_signal.h"
#include "core/plane/cover.h"
#include "core/plane/pixelize.h"
#include "core/plane/thesis_lines.h"
#include "tests/unit/core/plane_exact.h"

namespace latvox {
namespace {

std::vector<Segment> RandomPixelSegments(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int32_t> coordinate(-20, 20);
  std::vector<Segment> segments;
  for (int n = 0; n < 300; ++n) {
    const Vec2i a{coordinate(random), coordinate(random)}, b{coordinate(random), coordinate(random)};
    segments.push_back({a * kLatticeUnit, b * kLatticeUnit});
  }
  segments.push_back({{256, 512}, {256, 512}});
  return segments;
}

TEST(IncrementalLines, HaveExactlyOnePixelOnEveryLatticeLineAlongThePrincipalDirection) {
  for (const auto& l : PlaneLattices()) {
    for (int k = 0; k < 2; ++k) {
      for (const Segment& segment : RandomPixelSegments(21)) {
        const Vec2l d{segment.b_lat[0] - segment.a_lat[0], segment.b_lat[1] - segment.a_lat[1]};
        const Vec2l normal{-d[1], d[0]};
        const PlaneFrame& frame = PrincipalFrame(l.lattice.frames(k), normal);
        std::multiset<int32_t> lines, expected;
        const auto pixels = IncrementalLines({segment}, l.lattice, k);
        for (const Vec2i& ij : pixels) lines.insert(Dot(frame.r[0], ij));
        const auto [first, last] =
            std::minmax({Dot(frame.r[0], segment.a_lat) / kLatticeUnit, Dot(frame.r[0], segment.b_lat) / kLatticeUnit});
        for (int32_t a = first; a <= last; ++a) expected.insert(a);
        EXPECT_EQ(lines, expected) << l.name << " k " << k;
        // Theorem 1's inequality, for each of them.
        const Vec2l n = FirstNonzeroIsPositive(normal) ? normal : -normal;
        const int64_t twice_t = std::abs(Dot(n, frame.q)) * kLatticeUnit;
        for (const Vec2i& ij : pixels) {
          const Vec2l from{ij[0] * kLatticeUnit - segment.a_lat[0], ij[1] * kLatticeUnit - segment.a_lat[1]};
          EXPECT_TRUE(d == Vec2l{} || (-twice_t < 2 * Dot(n, from) && 2 * Dot(n, from) <= twice_t)) << l.name;
        }
      }
    }
  }
}

TEST(IncrementalLines, CoverEveryCrossedEdgeOfChainsWithoutASeamRule) {
  for (const auto& l : PlaneLattices()) {
    for (int k = 0; k < 2; ++k) {
      for (const Segment& segment : RandomPixelSegments(22)) {
        const auto edges = FindCrossings({segment}, l.lattice.frames(k)).links;
        EXPECT_EQ(Judge(edges, IncrementalLines({segment}, l.lattice, k)).tunnels, 0U) << l.name << " k " << k;
      }
    }
  }
}

TEST(IbanezLine, StepsBetweenNeighborsFromEndToEndAndEqualsTheIncrementalLine) {
  for (const auto& l : PlaneLattices()) {
    for (int k = 0; k < 2; ++k) {
      std::set<Vec2i> steps;
      for (const auto& neighbor : l.lattice.neighbors()) {
        if (neighbor.face_dimension >= 1 - k) steps.insert(neighbor.w);
      }
      for (const Segment& segment : RandomPixelSegments(23)) {
        const Vec2i from{segment.a_lat[0] / kLatticeUnit, segment.a_lat[1] / kLatticeUnit};
        const Vec2i to{segment.b_lat[0] / kLatticeUnit, segment.b_lat[1] / kLatticeUnit};
        std::vector<Vec2i> line = IbanezLine(from, to, l.lattice, k);
        EXPECT_EQ(line.front(), from);
        EXPECT_EQ(line.back(), to);
        for (size_t n = 1; n < line.size(); ++n) EXPECT_TRUE(steps.contains(line[n] - line[n - 1])) << l.name;
        const size_t length = line.size();
        SortUnique(line, StopSignal());
        EXPECT_EQ(line.size(), length) << "no pixel twice";
        EXPECT_EQ(line, IncrementalLines({segment}, l.lattice, k)) << l.name << " k " << k;
      }
    }
  }
}

TEST(IbanezLine, IsBresenhamsOnTheSquareLattice) {
  const PlaneLattice lattice = PlaneLattice::Named(NamedPlaneLattice::kSquare);
  const std::vector<Vec2i> expected{{0, 0}, {1, 0}, {2, 1}, {3, 1}, {4, 2}, {5, 2}, {6, 3}, {7, 3}};
  EXPECT_EQ(IbanezLine({0, 0}, {7, 3}, lattice, 1), expected);
  EXPECT_EQ(IbanezLine({0, 0}, {7, 3}, lattice, 0).size(), 11U) << "steps along the axes only";
}

TEST(BruteForceLines, ContainTheNearerEndOfEveryCrossedEdgeAndOnlyPixelsWithinReach) {
  for (const auto& l : PlaneLattices()) {
    for (const auto& [name, drawing] : plane_oracle::AdversarialDrawings(13, Directions(l.lattice, 0))) {
      const auto snapped = *Snap(ToWorld(drawing, l.lattice), l.lattice, {0, 0});
      for (int k = 0; k < 2; ++k) {
        double r = 0;
        for (const PlaneFrame& frame : l.lattice.frames(k)) {
          const Vec2d q = Apply(l.lattice.basis(), frame.q);
          r = std::max(r, std::hypot(q[0], q[1]) / 2);
        }
        const auto pixels = BruteForceLines(snapped.segments, l.lattice, k);
        const auto crossings = FindCrossings(snapped.segments, l.lattice.frames(k));
        EXPECT_TRUE(std::includes(pixels.begin(), pixels.end(), crossings.nearer.begin(), crossings.nearer.end()))
            << l.name << " k " << k << " " << name;
        for (const Vec2i& ij : pixels) {
          double nearest = INFINITY;
          for (const Segment& s : snapped.segments) {
            const auto world = [&](const Vec2i& p) {
              return Apply(l.lattice.basis(), Vec2d{p[0] / 256., p[1] / 256.});
            };
            const Vec2d d = world(s.b_lat - s.a_lat), p = world(ij * kLatticeUnit - s.a_lat);
            const double u = Dot(d, d) > 0 ? std::clamp(Dot(p, d) / Dot(d, d), 0., 1.) : 0;
            nearest = std::min(nearest, std::hypot(p[0] - u * d[0], p[1] - u * d[1]));
          }
          EXPECT_LE(nearest, r * (1 + 1e-6)) << l.name << " k " << k << " " << name;
        }
      }
    }
  }
}

TEST(BruteForceLines, OfOnePointAreADisc) {
  const std::vector<Polyline> point{{{{0, 0}}}};
  const PlaneGrid grid = Unscaled(PlaneLattice::Named(NamedPlaneLattice::kSquare));
  EXPECT_EQ(Digitized(point, grid, 0, false, LineAlgorithm::kBruteForce).pixels, (std::vector<Vec2i>{{0, 0}}));
  const std::vector<Polyline> corner{{{{0.5, 0.5}}}};  // exactly R from four pixels
  EXPECT_EQ(Digitized(corner, grid, 0, false, LineAlgorithm::kBruteForce).pixels,
            (std::vector<Vec2i>{{0, 0}, {0, 1}, {1, 0}, {1, 1}}));
  EXPECT_EQ(Digitized(corner, grid, 1, false, LineAlgorithm::kBruteForce).pixels, std::vector<Vec2i>{});
}

TEST(ThesisAlgorithms, NeverLeaveATunnelAndThinToMinimalSets) {
  for (const auto& l : PlaneLattices()) {
    for (const auto& [name, drawing] : plane_oracle::AdversarialDrawings(14, Directions(l.lattice, 0))) {
      for (LineAlgorithm algorithm : kAlgorithms) {
        for (int k = 0; k < 2; ++k) {
          for (bool minimal : {false, true}) {
            const auto result = Digitized(ToWorld(drawing, l.lattice), Unscaled(l.lattice), k, minimal, algorithm);
            EXPECT_EQ(result.tunnels, 0U) << l.name << " " << name << " algorithm " << static_cast<int>(algorithm);
            EXPECT_TRUE(!minimal || result.redundant == 0) << l.name << " " << name;
          }
        }
      }
    }
  }
}

TEST(ThesisAlgorithms, MovePointsToTheirNearestPixels) {
  std::mt19937 random(31);
  std::uniform_int_distribution<int32_t> coordinate(0, 2000);
  for (const auto& l : PlaneLattices()) {
    std::vector<Segment> segments;
    for (int n = 0; n < 200; ++n) {
      segments.push_back({{coordinate(random), coordinate(random)}, {coordinate(random), coordinate(random)}});
    }
    const auto rounded = RoundToPixels(segments, l.lattice);
    for (size_t n = 0; n < segments.size(); ++n) {
      const auto distance = [&](const Vec2i& ij) {
        const Vec2i d_lat = ij * kLatticeUnit - segments[n].a_lat;
        const Vec2d d = Apply(l.lattice.basis(), d_lat);
        return std::hypot(d[0], d[1]);
      };
      const Vec2i z{rounded[n].a_lat[0] / kLatticeUnit, rounded[n].a_lat[1] / kLatticeUnit};
      EXPECT_EQ(z * kLatticeUnit, rounded[n].a_lat) << "a pixel";
      for (int32_t i = -9; i <= 9; ++i) {
        for (int32_t j = -9; j <= 9; ++j) EXPECT_LE(distance(z) * (1 - 1e-9), distance(z + Vec2i{i, j})) << l.name;
      }
    }
  }
}

TEST(ThesisAlgorithms, KeepASinglePointAsAPixelUnlessMinimal) {
  const std::vector<Polyline> point{{{{3.2, -1.7}}}};
  const PlaneGrid grid = Unscaled(PlaneLattice::Named(NamedPlaneLattice::kSquare));
  for (LineAlgorithm algorithm : {LineAlgorithm::kIncremental, LineAlgorithm::kIbanez}) {
    EXPECT_EQ(Digitized(point, grid, 0, false, algorithm).pixels, (std::vector<Vec2i>{{3, -2}}));
    EXPECT_TRUE(Digitized(point, grid, 0, true, algorithm).pixels.empty());
  }
  EXPECT_TRUE(Digitized(point, grid, 0, false).pixels.empty()) << "a point crosses no edge";
}

}  // namespace
}  // namespace latvox
