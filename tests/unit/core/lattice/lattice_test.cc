// Lattices: neighbors, compared with the table and with exact Voronoi cells; frames, scaling, errors.
#include "core/lattice/lattice.h"

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <set>
#include <string>
#include <utility>

#include "core/lattice/cube_root.h"
#include "tests/oracle/oracle.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

constexpr double kRoot3Half = 0.86602540378443864676;

template <size_t D>
std::array<size_t, 3> Counts(const std::vector<Neighbor<D>>& neighbors) {
  std::array<size_t, 3> counts{};
  for (const auto& neighbor : neighbors) {
    for (int k = 0; k <= neighbor.face_dimension; ++k) ++counts[static_cast<size_t>(k)];
  }
  return counts;
}

template <size_t D>
std::map<std::array<int64_t, D>, int> ToOracle(const std::vector<Neighbor<D>>& neighbors) {
  std::map<std::array<int64_t, D>, int> out;
  for (const auto& neighbor : neighbors) {
    std::array<int64_t, D> w;
    std::copy(neighbor.w.begin(), neighbor.w.end(), w.begin());
    out[w] = neighbor.face_dimension;
  }
  return out;
}

struct NamedCase {
  const char* name;
  Mat3d basis;
  std::array<size_t, 3> counts;  // |N_0|, |N_1|, |N_2|
};

const NamedCase kNamed[] = {
    {"cartesian", {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, {26, 18, 6}},
    {"rectilinear", {{{1, 0, 0}, {0, 2.5, 0}, {0, 0, 0.125}}}, {26, 18, 6}},
    {"cartesian, rotated and swapped", {{{0, 0.6, 0.8}, {0, -0.8, 0.6}, {-1, 0, 0}}}, {26, 18, 6}},
    {"bcc", {{{2, 0, 0}, {0, 2, 0}, {1, 1, 1}}}, {14, 14, 14}},
    {"bcc, obtuse basis", {{{-1, 1, 1}, {1, -1, 1}, {1, 1, -1}}}, {14, 14, 14}},
    {"fcc", {{{1, 1, 0}, {1, 0, 1}, {0, 1, 1}}}, {18, 12, 12}},
    {"hexagonal prism", {{{1, 0, 0}, {0.5, kRoot3Half, 0}, {0, 0, 1}}}, {20, 20, 8}},
    {"hexagonal prism, tall", {{{1, 0, 0}, {0.5, kRoot3Half, 0}, {0, 0, 3}}}, {20, 20, 8}},
    {"generic", {{{1, 0.1, 0.2}, {-0.3, 1.1, 0.15}, {0.05, -0.2, 0.9}}}, {14, 14, 14}},
};

TEST(Neighbors, CountsOfKnownLatticesMatchTheirVoronoiCells) {
  for (const NamedCase& c : kNamed) {
    const auto neighbors = FindNeighbors<3>(c.basis);
    ASSERT_TRUE(neighbors.ok()) << c.name;
    EXPECT_EQ(Counts(*neighbors), c.counts) << c.name;
  }
}

TEST(NamedLattices, HaveTheNeighborsOfTheirRows) {
  for (const NamedBasis<3>& row : kNamedLattices) {
    const auto neighbors = FindNeighbors<3>(row.basis);
    ASSERT_TRUE(neighbors.ok()) << row.name;
    for (size_t k = 0; k < 3; ++k) EXPECT_EQ(static_cast<int>(Counts(*neighbors)[k]), row.neighbors[k]) << row.name;
    EXPECT_EQ(std::string(row.stretched_name), "stretched-" + std::string(row.name));
  }
  for (const NamedBasis<2>& row : kNamedPlaneLattices) {
    const auto neighbors = FindNeighbors<2>(row.basis);
    ASSERT_TRUE(neighbors.ok()) << row.name;
    for (size_t k = 0; k < 2; ++k) EXPECT_EQ(static_cast<int>(Counts(*neighbors)[k]), row.neighbors[k]) << row.name;
  }
  EXPECT_EQ(kHalfRoot3, std::sqrt(0.75));
}

TEST(Neighbors, CountsOfPlanarLatticesMatchTheirVoronoiCells) {
  const auto square = FindNeighbors<2>({{{1, 0}, {0, 1}}});
  const auto rectangle = FindNeighbors<2>({{{3, 0}, {0, 1}}});
  const auto hexagonal = FindNeighbors<2>({{{1, 0}, {0.5, kRoot3Half}}});
  const auto generic = FindNeighbors<2>({{{1, 0.2}, {0.3, 1.4}}});
  ASSERT_TRUE(square.ok() && rectangle.ok() && hexagonal.ok() && generic.ok());
  EXPECT_EQ(Counts(*square), (std::array<size_t, 3>{8, 4, 0}));
  EXPECT_EQ(Counts(*rectangle), (std::array<size_t, 3>{8, 4, 0}));
  EXPECT_EQ(Counts(*hexagonal), (std::array<size_t, 3>{6, 6, 0}));
  EXPECT_EQ(Counts(*generic), (std::array<size_t, 3>{6, 6, 0}));
}

// Bases whose Gram matrix is exact in doubles, so that the oracle sees the same symmetry as the tolerance does.
TEST(Neighbors, EqualExactVoronoiCellsOfSymmetricLattices) {
  for (const NamedCase& c : kNamed) {
    if (std::string_view(c.name).starts_with("hexagonal") || std::string_view(c.name).ends_with("swapped")) continue;
    EXPECT_EQ(ToOracle(*FindNeighbors<3>(c.basis)), oracle::VoronoiNeighbors<3>(oracle::GramOf<3>(c.basis))) << c.name;
  }
  const oracle::Gram<3> hexagonal{{{1, mpq_class(1, 2), 0}, {mpq_class(1, 2), 1, 0}, {0, 0, 1}}};
  EXPECT_EQ(ToOracle(*FindNeighbors<3>(kNamed[6].basis)), oracle::VoronoiNeighbors<3>(hexagonal));
}

TEST(Neighbors, EqualExactVoronoiCellsOfRandomBases) {
  constexpr unsigned kSeed = 20061;
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<int> entry(-9, 9);
  int tested = 0;
  while (tested < Dose(300, 60)) {
    Mat3d basis;
    for (auto& column : basis) {
      for (double& x : column) x = entry(random);  // small integers: ties and symmetric cells are frequent
    }
    if (Determinant(basis) == 0) continue;
    const auto neighbors = FindNeighbors<3>(basis);
    ASSERT_TRUE(neighbors.ok()) << neighbors.status() << " seed " << kSeed << " basis " << tested;
    ASSERT_EQ(ToOracle(*neighbors), oracle::VoronoiNeighbors<3>(oracle::GramOf<3>(basis)))
        << "seed " << kSeed << " basis " << tested;
    ++tested;
  }
}

// Products of two entries of their neighbors do not fit 32 bits.
TEST(Neighbors, OfSkewBasesAreThoseOfTheLattice) {
  const Mat3d skew{{{1, 0, 0}, {0x1p9, 1, 0}, {0, 0x1p11, 1}}};  // a basis of the integer lattice
  const auto neighbors = FindNeighbors<3>(skew);
  ASSERT_TRUE(neighbors.ok()) << neighbors.status();
  EXPECT_EQ(Counts(*neighbors), (std::array<size_t, 3>{26, 18, 6}));
  for (const auto& [w, face_dimension] : *neighbors) {
    const Vec3d v = Apply(skew, w);
    EXPECT_EQ(Dot(v, v), 3 - face_dimension);
  }
  const auto plane = FindNeighbors<2>({{{1, 0}, {0x1p20, 1}}});
  ASSERT_TRUE(plane.ok()) << plane.status();
  EXPECT_EQ(Counts(*plane), (std::array<size_t, 3>{8, 4, 0}));
}

TEST(Neighbors, AreClosedUnderNegationSortedAndNeverOddlyEqualModuloTwo) {
  constexpr unsigned kSeed = 7;
  std::mt19937 random(kSeed);
  std::normal_distribution<double> entry;
  for (int n = 0; n < 1000; ++n) {
    Mat3d basis;
    for (auto& column : basis) {
      for (double& x : column) x = entry(random);
    }
    const auto neighbors = FindNeighbors<3>(basis);
    ASSERT_TRUE(neighbors.ok()) << "seed " << kSeed << " basis " << n;
    std::set<Vec3i> all;
    for (const auto& neighbor : *neighbors) all.insert(neighbor.w);
    ASSERT_EQ(all.size(), neighbors->size());
    ASSERT_TRUE(std::is_sorted(neighbors->begin(), neighbors->end(), [](auto& a, auto& b) { return a.w < b.w; }));
    for (const Vec3i& w : all) {
      ASSERT_TRUE(all.count(-w));
      ASSERT_TRUE((w[0] | w[1] | w[2]) & 1) << "a neighbor in the parity class of 0";
    }
    ASSERT_EQ(Counts(*neighbors), (std::array<size_t, 3>{14, 14, 14})) << "a random cell is a truncated octahedron";
  }
}

// Lengths in a coset differ relatively little, but bound faces that are at least 1/100 as wide as the lattice's short
// vectors.
TEST(Neighbors, OfLongLatticesKeepTheirFaces) {
  const auto facets = [](const Mat3d& basis) {
    std::set<Vec3i> found;
    const auto neighbors = FindNeighbors<3>(basis);
    for (const auto& neighbor : neighbors.value()) {
      if (neighbor.face_dimension == 2) found.insert(neighbor.w);
    }
    return found;
  };
  const std::set<Vec3i> expected{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0},  {0, -1, 0},
                                 {0, 0, 1}, {0, 0, -1}, {1, 0, -1}, {-1, 0, 1}};
  EXPECT_EQ(facets({{{1, 0, 0}, {0, 1, 0}, {0.01, 0, 5000}}}), expected);
  EXPECT_EQ(facets({{{1, 0, 0}, {0, 1, 0}, {0.25, 0.25, 24000}}}).size(), 12);
  EXPECT_EQ(facets({{{1, 0, 0}, {0, 1, 0}, {0, 0, 24000}}}).size(), 6);
  const auto plane = FindNeighbors<2>({{{1, 0}, {0.25, 1e8}}});
  EXPECT_EQ(std::count_if(plane->begin(), plane->end(), [](const auto& n) { return n.face_dimension == 1; }), 6);
}

TEST(Lattice, RejectsBasesThatAreNotABasis) {
  const double nan = std::nan(""), infinity = INFINITY;
  const struct {
    Mat3d basis;
    const char* message;
  } cases[] = {
      {{{{1, 0, 0}, {0, 1, 0}, {1, 1, 0}}}, "basis: the 3 vectors are linearly dependent (rank below 3)"},
      {{{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}}, "basis: the 3 vectors are linearly dependent (rank below 3)"},
      {{{{1, 2, 3}, {2, 4, 6}, {3, 6, 9}}}, "basis: the 3 vectors are linearly dependent (rank below 3)"},
      {{{{1, 0, 0}, {0, 1, 0}, {0, -1, 0}}}, "basis: the 3 vectors are linearly dependent (rank below 3)"},
      {{{{-299, -301, -1}, {-1, -1, 0}, {1, 1, 0}}}, "basis: the 3 vectors are linearly dependent (rank below 3)"},
      {{{{1, 0, 0}, {0, 1, 0}, {0, -1, 1e-5}}},
       "basis: so flat or long that it is too skew for exact 64-bit arithmetic"},
      {{{{1, 0, 0}, {std::sqrt(2), 0, 0}, {0, 1, 0}}},
       "basis: the 3 vectors are linearly dependent (rank below 3), or so skew that a reduced basis takes one of them "
       "more than 1048576 times"},
      {{{{1, 0, 0}, {0, nan, 0}, {0, 0, 1}}}, "basis: entry nan is not finite"},
      {{{{1, 0, 0}, {0, infinity, 0}, {0, 0, 1}}}, "basis: entry inf is not finite"},
  };
  for (const auto& c : cases) {
    const auto lattice = Lattice::FromBasis(c.basis);
    ASSERT_EQ(lattice.status().code(), absl::StatusCode::kInvalidArgument) << c.message;
    EXPECT_EQ(lattice.status().message(), c.message);
  }
}

TEST(Lattice, RejectsTooSkewBasesWithAUsableOne) {
  const Mat3d bases[] = {
      {{{1, 0, 0}, {0, 1, 0}, {17, 5, 1}}},
      {{{1, 0, 0}, {0, 1, 0}, {100, 0, 1}}},
      {{{1, 0, 0}, {1 << 10, 1, 0}, {0, -1000, 1}}},
      {{{1, 0, 0}, {0, 1, 0.1}, {0.5, 0.5, 0.051}}},  // whose pairs are reduced, and hide (0, 0, 0.002)
  };
  for (const Mat3d& basis : bases) {
    const auto lattice = Lattice::FromBasis(basis);
    ASSERT_EQ(lattice.status().code(), absl::StatusCode::kInvalidArgument);
    const std::string message(lattice.status().message());
    ASSERT_NE(message.find("too skew"), std::string::npos) << message;
    Mat3d suggested;
    auto& s = suggested;
    const std::string numbers = message.substr(message.rfind(": ") + 2);
    ASSERT_EQ(std::sscanf(numbers.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf", &s[0][0], &s[0][1], &s[0][2],
                          &s[1][0], &s[1][1], &s[1][2], &s[2][0], &s[2][1], &s[2][2]),
              9);
    EXPECT_TRUE(Lattice::FromBasis(suggested).ok()) << numbers;
    EXPECT_NEAR(std::abs(Determinant(suggested) / Determinant(basis)), 1, 1e-4) << numbers;
  }
}

TEST(Lattice, OffersNoBasisThatIsRefusedInTurn) {
  const auto lattice = Lattice::FromBasis({{{1, 0, 0}, {0.3, 1, 0}, {0.3, 0.2, 100000}}});
  ASSERT_EQ(lattice.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_NE(lattice.status().message().find("so flat or long"), absl::string_view::npos) << lattice.status();
}

TEST(Lattice, AcceptsScalesFarFromOne) {
  for (double scale : {1e-30, 1e-3, 1e3, 1e30}) {
    const auto lattice = Lattice::FromBasis({{{2 * scale, 0, 0}, {0, 2 * scale, 0}, {scale, scale, scale}}});
    ASSERT_TRUE(lattice.ok()) << scale;
    EXPECT_NEAR(lattice->voxel_size() / scale, std::cbrt(4.0), 1e-12);
    EXPECT_EQ(lattice->frames(2).size(), 7U);
  }
}

TEST(Lattice, NamedOnesHaveUnitCellsAndScaleToAnyOther) {
  for (const NamedBasis<3>& named : kNamedLattices) {
    const Lattice lattice = Lattice::Named(named.lattice);
    EXPECT_EQ(lattice.name(), named.name);
    EXPECT_NEAR(lattice.voxel_size(), 1, 1e-12);
    const auto scaled = lattice.Scaled(0.37);
    ASSERT_TRUE(scaled.ok());
    EXPECT_NEAR(scaled->voxel_size(), 0.37, 1e-12);
    // Scaling to the reported size does not change it.
    EXPECT_EQ(lattice.Scaled(scaled->voxel_size())->voxel_size(), scaled->voxel_size());
    EXPECT_EQ(scaled->name(), named.name);
    for (size_t column = 0; column < 3; ++column) {
      const Vec3d unit = Apply(scaled->inverse(), scaled->basis()[column]);
      for (size_t row = 0; row < 3; ++row) EXPECT_NEAR(unit[row], row == column ? 1 : 0, 1e-12);
    }
  }
}

TEST(CubeRoot, IsTheNearestDouble) {
  constexpr unsigned kSeed = 31;
  std::mt19937_64 random(kSeed);
  for (int n = 0; n < 40000; ++n) {
    // All exponents, the least ones, which have fewer digits, and powers of 2.
    const double x = std::ldexp(static_cast<double>(n % 100 == 0 ? 1 : random() | 1), n % 2090 - 1074);
    if (!(x > 0 && std::isfinite(x))) continue;
    const double root = CubeRoot(x);
    const mpq_class middle_below = (mpq_class(std::nextafter(root, 0.0)) + root) / 2;
    const mpq_class middle_above = (mpq_class(std::nextafter(root, INFINITY)) + root) / 2;
    ASSERT_LT(middle_below * middle_below * middle_below, x) << x << ", seed " << kSeed;
    ASSERT_GT(middle_above * middle_above * middle_above, x) << x << ", seed " << kSeed;
  }
}

TEST(Lattice, CartesianOnesHaveTheSizeThatWasAskedFor) {
  for (const double size : {0.5, 0.3, 0.02, 1.0, 7.1, 1e-9, 65536.0}) {
    EXPECT_EQ(Lattice::Named(NamedLattice::kCartesian).Scaled(size)->voxel_size(), size);
  }
}

TEST(Lattice, ScalingKeepsTheDirectionsAndFindsNoneAnew) {
  const Lattice lattice = Lattice::FromBasis({{{1, 0, 0}, {0.3, 1.1, 0}, {0.2, 0.4, 0.9}}}).value();
  for (const double size : {1e-30, 0.37, 1e30}) {
    const Lattice scaled = lattice.Scaled(size).value();
    EXPECT_EQ(&scaled.neighbors(), &lattice.neighbors());
    EXPECT_EQ(Lattice::FromBasis(scaled.basis())->neighbors(), lattice.neighbors()) << size;
  }
  EXPECT_EQ(&Lattice::Named(NamedLattice::kBcc).frames(1), &Lattice::Named(NamedLattice::kBcc).frames(1));
  EXPECT_EQ(&PlaneLattice::Named(NamedPlaneLattice::kSquare).frames(1),
            &PlaneLattice::Named(NamedPlaneLattice::kSquare).frames(1));
  for (const double size : {1e-150, 1e150}) {
    EXPECT_EQ(lattice.Scaled(size).status(), absl::InvalidArgumentError("basis: its determinant over- or underflows"));
  }
}

TEST(Lattice, ABasisIsNamedAfterTheLatticeWhoseBasisItIsButForItsScales) {
  const auto name_of = [](const Mat3d& basis) { return std::string(Lattice::FromBasis(basis)->name()); };
  for (const NamedBasis<3>& row : kNamedLattices) {
    const Lattice lattice = Lattice::Named(row.lattice);
    const std::string name(row.name);
    const auto changed = [&](double x, double y, double z) {
      Mat3d basis = lattice.Scaled(0.37)->basis();
      for (Vec3d& column : basis) column = {column[0] * x, column[1] * y, column[2] * z};
      return basis;
    };
    EXPECT_EQ(name_of(lattice.basis()), name);
    EXPECT_EQ(name_of(changed(1, 1, 1)), name);
    EXPECT_EQ(name_of(changed(1e-9, 1e-9, 1e-9)), name);
    EXPECT_EQ(name_of(changed(1, 1 + 1e-12, 1)), name);
    EXPECT_EQ(name_of(changed(1, 1 + 1e-6, 1)), "stretched-" + name);
    EXPECT_EQ(name_of(changed(1, 2, 3.5)), "stretched-" + name);
    EXPECT_EQ(name_of(changed(-1, 1, 1)), "basis");
    Mat3d turned = changed(1, 1, 1);
    std::swap(turned[0], turned[2]);
    EXPECT_EQ(name_of(turned), "basis");
    turned = changed(1, 1, 1);
    turned[0][1] += 1e-6;
    EXPECT_EQ(name_of(turned), "basis");
    EXPECT_EQ(Lattice::FromBasis(changed(1, 2, 3))->Scaled(5)->name(), "stretched-" + name);
  }
}

TEST(Frame, IsUnimodularWithinBoundsAndEndsInItsDirection) {
  for (const NamedCase& c : kNamed) {
    const auto lattice = Lattice::FromBasis(c.basis);
    ASSERT_TRUE(lattice.ok()) << c.name << lattice.status();
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(lattice->frames(k).size() * 2, c.counts[static_cast<size_t>(k)]) << c.name;
      for (const Frame& frame : lattice->frames(k)) {
        EXPECT_TRUE(FirstNonzeroIsPositive(frame.q));
        EXPECT_EQ(frame.u[2], frame.q);
        EXPECT_EQ(Determinant(Mat<int32_t, 3>(frame.u)), 1);
        for (size_t row = 0; row < 3; ++row) {
          EXPECT_LE(std::abs(frame.r[row][0]) + std::abs(frame.r[row][1]) + std::abs(frame.r[row][2]), kMaxFrameRow);
          for (size_t column = 0; column < 3; ++column) {
            EXPECT_EQ(Dot(frame.r[row], frame.u[column]), row == column ? 1 : 0) << c.name;
          }
        }
      }
    }
  }
}

TEST(Frame, ExistsForEverySmallPrimitiveDirectionAndForNoLongOne) {
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      for (int k = -1; k <= 1; ++k) {
        if (i == 0 && j == 0 && k == 0) continue;
        EXPECT_TRUE(MakeFrame({i, j, k}).has_value()) << i << j << k;
      }
    }
  }
  EXPECT_FALSE(MakeFrame({9, 1, 0}).has_value());
  EXPECT_FALSE(MakeFrame({1, 6, 0}).has_value());
}

TEST(Frame, PrincipalDirectionIsTheStepThatLeavesThePlaneFastest) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  EXPECT_EQ(PrincipalFrame(lattice.frames(2), {1, -5, 3}).q, (Vec3i{0, 1, 0}));
  EXPECT_EQ(PrincipalFrame(lattice.frames(1), {1, -5, 3}).q, (Vec3i{0, 1, -1}));
  EXPECT_EQ(PrincipalFrame(lattice.frames(0), {1, -5, 3}).q, (Vec3i{1, -1, 1}));
  for (const NamedCase& c : kNamed) {
    const auto frames = Lattice::FromBasis(c.basis)->frames(0);
    for (const Frame& frame : frames) {
      // The first to attain the maximum, with any scale of the normal.
      const Vec<int64_t, 3> normal{frame.q[0] * 100 + 1, frame.q[1] * 100, frame.q[2] * 100 - 1};
      const Frame& principal = PrincipalFrame(frames, normal);
      for (const Frame& other : frames) {
        EXPECT_GE(std::abs(Dot(normal, principal.q)), std::abs(Dot(normal, other.q))) << c.name;
      }
    }
  }
}

TEST(Lattice, RefusesABasisSoFlatOrLongThatLengthsCannotBeToldApart) {
  for (const Mat3d& basis : {Mat3d{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1e6}}}, Mat3d{{{1, 0, 0}, {0, 1e6, 0}, {0, 0, 1e6}}},
                             Mat3d{{{1, 0, 0}, {0.3, 1.3, 0}, {0.2, 0.3, 5e4}}}}) {
    const auto lattice = Lattice::FromBasis(basis);
    ASSERT_FALSE(lattice.ok());
    EXPECT_EQ(lattice.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_NE(lattice.status().message().find("basis: so flat or long"), std::string_view::npos) << lattice.status();
  }
  EXPECT_TRUE(Lattice::FromBasis({{{1, 0, 0}, {0, 100, 0}, {0, 0, 1000}}}).ok());
}

}  // namespace
}  // namespace latvox
