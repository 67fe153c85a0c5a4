// The plane's lattices, its one rounding, and its crossing rule, compared with the exact oracle and the theorems.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "core/plane/crossing2.h"
#include "tests/oracle/oracle.h"
#include "tests/unit/core/plane_exact.h"

namespace latvox {
namespace {

using plane_oracle::Int2;

std::array<size_t, 2> Counts(const std::vector<Neighbor<2>>& neighbors) {
  std::array<size_t, 2> counts{};
  for (const auto& neighbor : neighbors) {
    for (int k = 0; k <= neighbor.face_dimension; ++k) ++counts[static_cast<size_t>(k)];
  }
  return counts;
}

TEST(PlaneLattice, HasFourAndEightNeighborsIfRectangularElseSix) {
  for (const auto& l : PlaneLattices()) {
    const bool rectangular = l.name.find("square") == 0 || l.name == "mirrored rectangle";
    const std::array<size_t, 2> expected = rectangular ? std::array<size_t, 2>{8, 4} : std::array<size_t, 2>{6, 6};
    EXPECT_EQ(Counts(l.lattice.neighbors()), expected) << l.name;
    for (int k = 0; k < 2; ++k) EXPECT_EQ(2 * l.lattice.frames(k).size(), expected[static_cast<size_t>(k)]) << l.name;
  }
}

TEST(PlaneLattice, NeighborsEqualExactVoronoiCells) {
  const auto expect_equal = [](const PlaneLattice& lattice, const oracle::Gram<2>& gram) {
    std::map<Int2, int> neighbors;
    for (const auto& neighbor : lattice.neighbors()) neighbors[ToOracle(neighbor.w)] = neighbor.face_dimension;
    EXPECT_EQ(neighbors, oracle::VoronoiNeighbors<2>(gram));
  };
  const mpq_class half(1, 2);
  expect_equal(PlaneLattice::Named(NamedPlaneLattice::kHexagonal), {{{1, half}, {half, 1}}});
  for (int a = 0; a <= 4; ++a) {
    for (int b = -4; b <= 4; ++b) {
      for (int c = -4; c <= 4; ++c) {
        for (int d = -4; d <= 4; ++d) {
          const Mat2d basis{{{double(a), double(b)}, {double(c), double(d)}}};
          if (a * d - b * c == 0) continue;
          const auto lattice = PlaneLattice::FromBasis(basis);
          if (lattice.ok()) expect_equal(*lattice, oracle::GramOf<2>(basis));
        }
      }
    }
  }
}

TEST(PlaneLattice, NamedOnesHaveUnitCellsAndScaleToAnyOther) {
  for (const NamedBasis<2>& named : kNamedPlaneLattices) {
    const PlaneLattice lattice = PlaneLattice::Named(named.lattice);
    EXPECT_EQ(lattice.name(), named.name);
    EXPECT_NEAR(lattice.pixel_size(), 1, 1e-12);
    const auto scaled = lattice.Scaled(0.37);
    ASSERT_TRUE(scaled.ok());
    EXPECT_NEAR(scaled->pixel_size(), 0.37, 1e-12);
    for (size_t column = 0; column < 2; ++column) {
      const Vec2d unit = Apply(scaled->inverse(), scaled->basis()[column]);
      for (size_t row = 0; row < 2; ++row) EXPECT_NEAR(unit[row], row == column ? 1 : 0, 1e-12);
    }
  }
}

TEST(PlaneLattice, FramesAreUnimodularWithinBoundsAndEndInTheirDirection) {
  std::vector<PlaneLattice> lattices;
  for (const auto& l : PlaneLattices()) lattices.push_back(l.lattice);
  lattices.push_back(*PlaneLattice::FromBasis({{{1, 0}, {14, 1}}}));  // steps at the bound
  for (const PlaneLattice& lattice : lattices) {
    for (const PlaneFrame& frame : lattice.frames(0)) {
      EXPECT_TRUE(FirstNonzeroIsPositive(frame.q));
      EXPECT_EQ(frame.u[1], frame.q);
      EXPECT_EQ(frame.r[0], (Vec2i{frame.q[1], -frame.q[0]}));
      EXPECT_EQ(Determinant(Mat<int32_t, 2>(frame.u)), 1);
      for (size_t row = 0; row < 2; ++row) {
        EXPECT_LE(std::abs(frame.r[row][0]) + std::abs(frame.r[row][1]), kMaxPlaneStep);
        for (size_t column = 0; column < 2; ++column) {
          EXPECT_EQ(Dot(frame.r[row], frame.u[column]), row == column ? 1 : 0);
        }
      }
    }
  }
}

TEST(PlaneLattice, RejectsWhatIsNoBasisOrTooSkewWithAUsableOne) {
  EXPECT_EQ(PlaneLattice::FromBasis({{{1, 2}, {2, 4}}}).status().message(),
            "basis: the 2 vectors are linearly dependent (rank below 2)");
  EXPECT_EQ(PlaneLattice::FromBasis({{{1, 0}, {0, NAN}}}).status().message(), "basis: entry nan is not finite");
  for (const double multiple : {15.0, 201.0, 1e6}) {
    const auto skew = PlaneLattice::FromBasis({{{1, 0}, {multiple, 1}}});
    ASSERT_EQ(skew.status().code(), absl::StatusCode::kInvalidArgument);
    const std::string message(skew.status().message());
    Mat2d usable;
    ASSERT_EQ(std::sscanf(message.substr(message.rfind(": ") + 2).c_str(), "%lf,%lf,%lf,%lf", &usable[0][0],
                          &usable[0][1], &usable[1][0], &usable[1][1]),
              4)
        << message;
    EXPECT_TRUE(PlaneLattice::FromBasis(usable).ok()) << message;
  }
}

TEST(PolylineValidation, NamesTheElement) {
  EXPECT_EQ(CheckPolylines(std::vector<Polyline>{}).message(), "polylines: there are none");
  EXPECT_EQ(CheckPolylines({Polyline{{{0, 0}}}, Polyline{}}).message(), "polylines: polyline 1 has no points");
  EXPECT_EQ(CheckPolylines({Polyline{{{0, 0}, {1, INFINITY}}}}).message(),
            "polylines: point 1 of polyline 0 is not finite");
  EXPECT_TRUE(CheckPolylines({Polyline{{{0, 0}}}}).ok());
}

const PlaneLattice& Square() { return PlaneLattices()[0].lattice; }

TEST(PolylineSnap, RoundsHalfToEvenInUnitsOfAPixels256thPart) {
  const double half = 0.5 / 256;
  const auto snapped = Snap({Polyline{{{half, 3 * half}, {-half, -3 * half}, {0.3, -5}}, true}}, Square(), {0, 0});
  ASSERT_TRUE(snapped.ok());
  ASSERT_EQ(snapped->segments.size(), 3U);
  const auto global = [&](const Vec2i& v_lat) { return v_lat + snapped->base_ij * kLatticeUnit; };
  EXPECT_EQ(global(snapped->segments[0].a_lat), (Vec2i{0, 2}));
  EXPECT_EQ(global(snapped->segments[0].b_lat), (Vec2i{0, -2}));
  EXPECT_EQ(global(snapped->segments[2].a_lat), (Vec2i{77, -5 * 256}));
  EXPECT_EQ(global(snapped->segments[2].b_lat), (Vec2i{0, 2}));
  EXPECT_EQ(snapped->base_ij[0] & 1, 0);
  EXPECT_EQ(snapped->base_ij[1] & 1, 0);
}

TEST(PolylineSnap, AcceptsTheLargestExtentAndRefusesOneMoreAndPositionsThatOverflow) {
  const auto to = [](double size, const Vec2d& origin) {
    return Snap({Polyline{{{0, 0}, {1, size}}}}, Square(), origin).status();
  };
  EXPECT_TRUE(to(kMaxExtent - 1, {0, 0}).ok());
  EXPECT_EQ(to(kMaxExtent, {0, 0}).message(),
            "pixel_size: at 1 the polylines extend over 131073 pixels on lattice axis j, the limit is 131072");
  EXPECT_EQ(to(kMaxExtent, {0, 0}).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(to(1, {-1e10, 0}).message(),
            "origin: it puts the polylines at lattice coordinate 1e+10 on axis i, the limit is 536870912");
  EXPECT_EQ(to(1, {-1e10, 0}).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(to(1e308, {0, -1e308}).code(), absl::StatusCode::kResourceExhausted);
}

Segment ToCore(const plane_oracle::Line& line) {
  Segment segment;
  for (size_t m = 0; m < 2; ++m) {
    segment.a_lat[m] = static_cast<int32_t>(line[0][m]);
    segment.b_lat[m] = static_cast<int32_t>(line[1][m]);
  }
  return segment;
}

std::map<plane_oracle::Ends, int> CoreCrossings(const plane_oracle::Curve& curve, const PlaneFrame& frame,
                                                const std::optional<plane_oracle::Box>& window = {}) {
  std::map<plane_oracle::Ends, int> crossings;
  for (const auto& line : curve) {
    ForEachCrossing(ToCore(line), frame, [&](const Vec2i& nearer, const Vec2i& farther) {
      if (!window || window->Contains(ToOracle(nearer))) ++crossings[{ToOracle(nearer), ToOracle(farther)}];
    });
  }
  return crossings;
}

TEST(PlaneCrossingRule, EqualsTheOracleOnAdversarialDrawingsInEveryDirection) {
  size_t crossings = 0;
  for (const auto& l : PlaneLattices()) {
    for (unsigned seed : {1U, 2U, 3U}) {
      for (const auto& [name, drawing] : plane_oracle::AdversarialDrawings(seed, Directions(l.lattice, 0))) {
        const auto curve = CurveOf(drawing);
        for (const PlaneFrame& frame : l.lattice.frames(0)) {
          const auto core = CoreCrossings(curve, frame);
          crossings += core.size();
          ASSERT_EQ(core, plane_oracle::Crossings(curve, ToOracle(frame.q)))
              << l.name << " seed " << seed << " " << name << " q " << frame.q[0] << "," << frame.q[1];
        }
      }
    }
  }
  EXPECT_GT(crossings, 10000U);
}

TEST(PlaneCrossingRule, EqualsTheOracleOnSegmentsAtTheLimitsOfTheWidths) {
  constexpr unsigned kSeed = 5;
  std::mt19937 random(kSeed);
  constexpr int64_t kTop = (int64_t{kMaxExtent} + 2) * kLatticeUnit - 1;
  std::uniform_int_distribution<int64_t> coordinate(0, kTop);
  const PlaneLattice steepest = *PlaneLattice::FromBasis({{{1, 0}, {14, 1}}});
  std::vector<plane_oracle::Line> lines{{{{0, 0}, {kTop, kTop}}}, {{{0, kTop}, {kTop, 0}}}, {{{0, 1}, {kTop, 0}}}};
  for (int n = 0; n < 3; ++n) {
    lines.push_back({{{coordinate(random), coordinate(random)}, {coordinate(random), coordinate(random)}}});
  }
  size_t crossings = 0;
  for (const PlaneLattice& lattice : {Square(), steepest}) {
    for (const auto& line : lines) {
      for (int64_t eighths = 0; eighths <= 8; eighths += 4) {
        plane_oracle::Box window;
        for (size_t m = 0; m < 2; ++m) {
          const int64_t middle = (line[0][m] + (line[1][m] - line[0][m]) / 8 * eighths) >> 8;
          window.lo[m] = middle - 5;
          window.hi[m] = middle + 5;
        }
        for (const PlaneFrame& frame : lattice.frames(0)) {
          const auto core = CoreCrossings({line}, frame, window);
          crossings += core.size();
          ASSERT_EQ(core, plane_oracle::Crossings({line}, ToOracle(frame.q), window)) << kSeed;
        }
      }
    }
  }
  EXPECT_GT(crossings, 500U);
}

TEST(PlaneCrossingRule, CrossesEveryLatticeLineEvenlyOnClosedCurves) {
  for (const auto& l : PlaneLattices()) {
    for (const auto& [name, drawing] : plane_oracle::AdversarialDrawings(4, Directions(l.lattice, 0))) {
      for (const auto& contour : drawing) {
        if (!contour.closed) continue;
        for (const PlaneFrame& frame : l.lattice.frames(0)) {
          std::map<int64_t, int> on_line;
          for (const auto& [ends, count] : CoreCrossings(plane_oracle::CurveOf({contour}), frame)) {
            on_line[ends.first[0] * frame.r[0][0] + ends.first[1] * frame.r[0][1]] += count;
          }
          for (const auto& [a, count] : on_line) EXPECT_EQ(count % 2, 0) << l.name << " " << name << " line " << a;
        }
      }
    }
  }
}

// The line { x : n.x = offset }, x in 1/256 pixel, as a segment far larger than kBox.
constexpr plane_oracle::Box kBox{{-7, -7}, {7, 7}};
plane_oracle::Line LongSegment(const Int2& n, int64_t offset) {
  constexpr int64_t kFar = 256 * 300;
  const size_t solved = n[0] != 0 ? 0 : 1, free = 1 - solved;
  Int2 p{};
  while ((offset - n[free] * p[free]) % n[solved] != 0) ++p[free];  // ends, as the entries of n have no common factor
  p[solved] = (offset - n[free] * p[free]) / n[solved];
  return {{{p[0] + kFar * n[1], p[1] - kFar * n[0]}, {p[0] - kFar * n[1], p[1] + kFar * n[0]}}};
}

std::set<Int2> DigitizedLine(const Int2& n, int64_t offset, const PlaneLattice& lattice, int k) {
  std::set<Int2> pixels;
  for (const PlaneFrame& frame : lattice.frames(k)) {
    for (const auto& [ends, count] : CoreCrossings({LongSegment(n, offset)}, frame, kBox)) pixels.insert(ends.first);
  }
  return pixels;
}

// { z : -t < n.z - offset/256 <= t } with 2t = width, n turned so that its first nonzero entry is positive.
std::set<Int2> Slab(Int2 n, int64_t offset, int64_t width) {
  if (n[0] < 0 || (n[0] == 0 && n[1] < 0)) {
    n = {-n[0], -n[1]};
    offset = -offset;
  }
  std::set<Int2> pixels;
  for (int64_t i = kBox.lo[0]; i <= kBox.hi[0]; ++i) {
    for (int64_t j = kBox.lo[1]; j <= kBox.hi[1]; ++j) {
      const int64_t twice_d = 2 * (256 * (n[0] * i + n[1] * j) - offset);
      if (-256 * width < twice_d && twice_d <= 256 * width) pixels.insert({i, j});
    }
  }
  return pixels;
}

// Calls f(normal, offset) for every primitive normal with entries up to 6; many offsets make ties.
template <class F>
void ForEachLine(F f) {
  for (int64_t x = -6; x <= 6; ++x) {
    for (int64_t y = -6; y <= 6; ++y) {
      if (std::gcd(x, y) != 1) continue;
      for (int64_t offset : {0, 128, 256, -128, 64, 1, -77, 384, 127, 129}) f(Int2{x, y}, offset);
    }
  }
}

TEST(PlaneCrossingRule, EqualsTheoremsTwoAndThreeOnSquareLinesTiesIncluded) {
  ForEachLine([](const Int2& n, int64_t offset) {
    const int64_t x = std::abs(n[0]), y = std::abs(n[1]);
    EXPECT_EQ(DigitizedLine(n, offset, Square(), 1), Slab(n, offset, std::max(x, y))) << n[0] << "," << n[1];
    EXPECT_EQ(DigitizedLine(n, offset, Square(), 0), Slab(n, offset, x + y)) << n[0] << "," << n[1];
  });
}

TEST(PlaneCrossingRule, EqualsTheoremOneOnEveryLatticeTiesIncluded) {
  for (const auto& l : PlaneLattices()) {
    for (int k = 0; k < 2; ++k) {
      ForEachLine([&](const Int2& n, int64_t offset) {
        int64_t width = 0;  // 2t = max |q.n|
        for (const auto& neighbor : l.lattice.neighbors()) {
          if (neighbor.face_dimension < k) continue;
          width = std::max(width, std::abs(n[0] * neighbor.w[0] + n[1] * neighbor.w[1]));
        }
        EXPECT_EQ(DigitizedLine(n, offset, l.lattice, k), Slab(n, offset, width))
            << l.name << " k " << k << " normal " << n[0] << "," << n[1] << " offset " << offset;
      });
    }
  }
}

// Theorem 1 in the world: t = max d_i cos(alpha_i) over the hexagon's three directions, for lines that leave no tie.
TEST(PlaneCrossingRule, EqualsTheoremOneInWorldCoordinatesOnTheHexagonalLattice) {
  const PlaneLattice lattice = PlaneLattice::Named(NamedPlaneLattice::kHexagonal);
  ForEachLine([&](const Int2& n, int64_t offset) {
    if (offset % 2 == 0) return;
    const Mat2d& v = lattice.basis();
    const plane_oracle::Line line = LongSegment(n, offset);
    const Vec2d d = Apply(v, Vec2d{double(line[1][0] - line[0][0]), double(line[1][1] - line[0][1])});
    const Vec2d normal = Vec2d{-d[1], d[0]} * (1 / std::hypot(d[0], d[1]));
    const double interface_distance = std::hypot(v[0][0], v[0][1]) / 2;
    double t = 0;
    for (int degrees : {0, 60, 120}) {
      const Vec2d direction{std::cos(degrees * M_PI / 180), std::sin(degrees * M_PI / 180)};
      t = std::max(t, interface_distance * std::abs(Dot(direction, normal)));
    }
    std::set<Int2> pixels;
    for (int64_t i = kBox.lo[0]; i <= kBox.hi[0]; ++i) {
      for (int64_t j = kBox.lo[1]; j <= kBox.hi[1]; ++j) {
        const Vec2d from = Apply(v, Vec2d{double(i) - double(line[0][0]) / 256, double(j) - double(line[0][1]) / 256});
        if (std::abs(Dot(normal, from)) < t) pixels.insert({i, j});
      }
    }
    EXPECT_EQ(DigitizedLine(n, offset, lattice, 0), pixels) << n[0] << "," << n[1] << " offset " << offset;
  });
}

}  // namespace
}  // namespace latvox
