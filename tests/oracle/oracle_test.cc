#include "tests/oracle/oracle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>

#include "tests/oracle/meshes.h"

namespace latvox::oracle {
namespace {

constexpr uint64_t kSeed = 20060801;

template <size_t D>
struct Lattice {
  std::string name;
  Gram<D> gram;
  std::array<size_t, D> count;  // neighbors with a shared face of dimension >= 0, 1, (2)
};

std::vector<Lattice<3>> Lattices3() {
  const mpq_class half(1, 2);
  return {{"cartesian", GramOf<3>({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}), {26, 18, 6}},
          {"rectilinear", GramOf<3>({{{0.5, 0, 0}, {0, 3, 0}, {0, 0, 1}}}), {26, 18, 6}},
          {"bcc", GramOf<3>({{{2, 0, 0}, {0, 2, 0}, {1, 1, 1}}}), {14, 14, 14}},
          {"bcc_other_basis", GramOf<3>({{{-1, 1, 1}, {1, -1, 1}, {1, 1, -1}}}), {14, 14, 14}},
          {"fcc", GramOf<3>({{{1, 1, 0}, {1, 0, 1}, {0, 1, 1}}}), {18, 12, 12}},
          {"fcc_unreduced", GramOf<3>({{{1, 1, 0}, {3, 2, 1}, {1, 4, -1}}}), {18, 12, 12}},
          {"hexagonal_prism", {{{1, half, 0}, {half, 1, 0}, {0, 0, 2}}}, {20, 20, 8}},
          {"generic", GramOf<3>({{{1, 0.1, 0.2}, {0.3, 1.1, -0.2}, {-0.4, 0.2, 0.9}}}), {14, 14, 14}},
          {"generic_skew", GramOf<3>({{{1, 0.1, 0}, {7.3, 1, 0.2}, {-5.2, 3.2, 1.7}}}), {14, 14, 14}}};
}

std::vector<Lattice<2>> Lattices2() {
  const mpq_class half(1, 2);
  return {{"square", GramOf<2>({{{1, 0}, {0, 1}}}), {8, 4}},
          {"hexagonal", {{{1, half}, {half, 1}}}, {6, 6}},
          {"generic", GramOf<2>({{{1, 0.2}, {5.3, 1.7}}}), {6, 6}}};
}

// One set of directions for each kind of Voronoi cell and each k that differs, named after the lowest such k.
std::vector<std::pair<std::string, std::vector<Int3>>> DirectionSets() {
  std::vector<std::pair<std::string, std::vector<Int3>>> sets;
  for (const auto& lattice : Lattices3()) {
    if (lattice.name == "rectilinear" || lattice.name == "generic_skew") continue;
    const auto neighbors = VoronoiNeighbors<3>(lattice.gram);
    std::vector<Int3> before;
    for (int k = 0; k < 3; ++k) {
      const auto directions = Directions(neighbors, k);
      if (directions != before) sets.push_back({lattice.name + "_k" + std::to_string(k), directions});
      before = directions;
    }
  }
  return sets;
}

std::vector<Int3> CartesianDirections() { return Directions(VoronoiNeighbors<3>(Lattices3()[0].gram), 0); }

template <size_t D>
void ExpectCountsAndSymmetry(const Lattice<D>& lattice) {
  SCOPED_TRACE(lattice.name);
  const auto neighbors = VoronoiNeighbors<D>(lattice.gram);
  for (size_t k = 0; k < D; ++k) {
    EXPECT_EQ(std::count_if(neighbors.begin(), neighbors.end(),
                            [k](const auto& n) { return n.second >= static_cast<int>(k); }),
              lattice.count[k])
        << "k = " << k;
  }
  for (const auto& [w, dimension] : neighbors) {
    auto negated = w;
    for (int64_t& c : negated) c = -c;
    ASSERT_TRUE(neighbors.contains(negated));
    EXPECT_EQ(neighbors.at(negated), dimension);
    EXPECT_TRUE(std::any_of(w.begin(), w.end(), [](int64_t c) { return c % 2 != 0; })) << "an even neighbor";
  }
}

TEST(VoronoiNeighbors, HaveTheKnownCountsAndAreClosedUnderNegation) {
  for (const auto& lattice : Lattices3()) ExpectCountsAndSymmetry(lattice);
  for (const auto& lattice : Lattices2()) ExpectCountsAndSymmetry(lattice);
}

// A second way to the same neighbors. The cell of w meets the origin's iff w is shortest in its coset of twice the
// lattice. The face's dimension is 3 minus the rank of the shortest vectors there.
TEST(VoronoiNeighbors, AreTheShortestVectorsOfTheirCosets) {
  for (const auto& lattice : Lattices3()) {
    if (lattice.name == "generic_skew" || lattice.name == "fcc_unreduced") continue;  // need a larger range
    SCOPED_TRACE(lattice.name);
    std::map<Int3, std::pair<mpq_class, std::vector<Int3>>> shortest;
    constexpr int64_t kRange = 3;
    for (int64_t i = -kRange; i <= kRange; ++i) {
      for (int64_t j = -kRange; j <= kRange; ++j) {
        for (int64_t k = -kRange; k <= kRange; ++k) {
          const Int3 w{i, j, k};
          const Int3 coset{i & 1, j & 1, k & 1};
          if (coset == Int3{}) continue;
          mpq_class square;
          for (size_t a = 0; a < 3; ++a) {
            for (size_t b = 0; b < 3; ++b) square += lattice.gram[a][b] * w[a] * w[b];
          }
          auto [found, is_new] = shortest.try_emplace(coset, square, std::vector<Int3>{});
          auto& [best, vectors] = found->second;
          if (square < best) vectors.clear();
          if (square <= best) {
            best = square;
            vectors.push_back(w);
          }
        }
      }
    }
    const auto determinant = [](const Int3& a, const Int3& b, const Int3& c) {
      return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
             a[2] * (b[0] * c[1] - b[1] * c[0]);
    };
    std::map<Int3, int> expected;
    for (const auto& [coset, best] : shortest) {
      const auto& vectors = best.second;
      int rank = vectors.size() > 2 ? 2 : 1;  // only ±w are parallel
      for (const Int3& a : vectors) {
        for (const Int3& b : vectors) {
          for (const Int3& c : vectors) rank = determinant(a, b, c) != 0 ? 3 : rank;
        }
      }
      for (const Int3& w : vectors) expected[w] = 3 - rank;
    }
    EXPECT_EQ(VoronoiNeighbors<3>(lattice.gram), expected);
  }
}

TEST(AdversarialMeshes, AreManyNamedApartAndDeterministic) {
  const auto meshes = AdversarialMeshes(kSeed, CartesianDirections());
  const auto again = AdversarialMeshes(kSeed, CartesianDirections());
  ASSERT_EQ(meshes.size(), again.size());
  std::set<std::string> names;
  for (size_t i = 0; i < meshes.size(); ++i) {
    EXPECT_TRUE(names.insert(meshes[i].name).second) << meshes[i].name;
    EXPECT_EQ(meshes[i].triangles, again[i].triangles) << meshes[i].name;
  }
  EXPECT_GT(meshes.size(), 200u);
  EXPECT_GT(std::count_if(meshes.begin(), meshes.end(), [](const NamedMesh& m) { return m.closed; }), 60);
}

// Triangles that share an edge must agree on the lines through it, for any direction, ties included.
TEST(Crossings, AreEvenOnEveryLineOfAClosedMesh) {
  for (const auto& [lattice, directions] : DirectionSets()) {
    if (!lattice.ends_with("_k0")) continue;
    for (const NamedMesh& mesh : AdversarialMeshes(kSeed, directions)) {
      if (!mesh.closed || mesh.box) continue;
      SCOPED_TRACE(lattice + " " + mesh.name);
      for (const Int3& q : directions) {
        std::map<Int3, int> count;
        for (const Crossing& crossing : Crossings(mesh.triangles, q)) ++count[LineOf(crossing.near_end, q)];
        for (const auto& [line, crossings] : count) EXPECT_EQ(crossings % 2, 0);
      }
    }
  }
}

TEST(Crossings, EnterAnOutwardOrientedSolidThenLeaveIt) {
  const auto directions = CartesianDirections();
  size_t lines = 0;
  for (const NamedMesh& mesh : AdversarialMeshes(kSeed, directions)) {
    const bool inside_out = mesh.name.starts_with("shell/inside_out");
    const bool convex = mesh.triangles.size() <= 12 && (mesh.name.starts_with("shell/cube_") ||
                                                        mesh.name.starts_with("shell/octahedron_") || inside_out);
    if (!convex) continue;
    SCOPED_TRACE(mesh.name);
    for (const Int3& q : directions) {
      std::map<Int3, std::map<Int3, int>> turns;  // by line, then along it: q's first nonzero component is positive
      for (const Crossing& c : Crossings(mesh.triangles, q)) {
        turns[LineOf(c.near_end, q)][std::min(c.near_end, c.far_end)] += c.orientation;
      }
      for (const auto& [line, along] : turns) {
        ++lines;
        if (along.size() == 1) {
          EXPECT_EQ(along.begin()->second, 0);
          continue;
        }
        ASSERT_EQ(along.size(), 2u);
        EXPECT_EQ(along.begin()->second, inside_out ? 1 : -1);
        EXPECT_EQ(along.rbegin()->second, inside_out ? -1 : 1);
      }
    }
  }
  EXPECT_GT(lines, 1000u);
}

// The shift is the same for all directions. So the parity of one direction's crossings tells which voxels are inside a
// closed mesh. That determines the parity of crossings of every other direction's edges.
TEST(Crossings, OfAllDirectionsAgreeOnTheInteriorOfAClosedMesh) {
  const auto directions = CartesianDirections();
  const Box box{{-14, -14, -14}, {14, 14, 14}};
  for (const NamedMesh& mesh : AdversarialMeshes(kSeed, directions)) {
    if (!mesh.closed || mesh.box) continue;
    SCOPED_TRACE(mesh.name);
    std::map<Edge, int> parity;
    std::set<Int3> toggles;  // lower ends of edges along the last axis that are crossed an odd number of times
    const Int3 up{0, 0, 1};
    for (const Int3& q : directions) {
      for (const Crossing& crossing : Crossings(mesh.triangles, q, box)) {
        parity[MakeEdge(crossing.near_end, crossing.far_end)] ^= 1;
        if (q != up) continue;
        const Int3 low = std::min(crossing.near_end, crossing.far_end);
        if (!toggles.insert(low).second) toggles.erase(low);
      }
    }
    const auto inside = [&](const Int3& z) {
      return std::count_if(toggles.begin(), toggles.end(),
                           [&z](const Int3& t) { return t[0] == z[0] && t[1] == z[1] && t[2] >= z[2]; }) %
             2;
    };
    for (const auto& [edge, odd] : parity) EXPECT_EQ(inside(edge.a) != inside(edge.b), odd == 1);
    for (const Int3& toggle : toggles) {
      for (const Int3& q : directions) {  // edges that differ are crossed
        const Int3 other{toggle[0] + q[0], toggle[1] + q[1], toggle[2] + q[2]};
        if (inside(toggle) == inside(other)) continue;
        EXPECT_TRUE(parity.contains(MakeEdge(toggle, other)));
      }
    }
  }
}

// Compares the polynomials with a shift by small rational numbers, for all lines and all triangles.
TEST(Crossings, EqualThoseOfAnActualTinyShift) {
  using Point = std::array<mpq_class, 3>;
  const auto determinant = [](const Point& a, const Point& b, const Point& c) -> mpq_class {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  };
  mpq_class tiny[3];
  for (unsigned i = 0; i < 3; ++i) tiny[i] = mpq_class(1, mpz_class(1) << (100 * (i + 1)));
  const Box box{{-3, -3, -3}, {3, 3, 3}};
  const std::vector<Int3> directions{{1, 0, 0}, {1, 1, 0}, {0, 1, -1}, {1, -1, 1}, {1, 1, -2}, {2, -3, 5}};
  for (const NamedMesh& mesh : AdversarialMeshes(kSeed, directions)) {
    if (mesh.triangles.size() > 24 || (mesh.name.starts_with("plane/") && !mesh.name.ends_with("_at_128"))) continue;
    SCOPED_TRACE(mesh.name);
    for (const Int3& q : directions) {
      std::multiset<std::pair<Int3, Int3>> expected, found;
      for (const Triangle& t : mesh.triangles) {
        Point v0, e1, e2, back;
        for (size_t i = 0; i < 3; ++i) {
          v0[i] = t[0][i] + tiny[i];
          e1[i] = t[1][i] - t[0][i];
          e2[i] = t[2][i] - t[0][i];
          back[i] = -kUnitsPerVoxel * q[i];
        }
        const mpq_class all = determinant(e1, e2, back);
        if (all == 0) continue;
        for (int64_t i = box.lo[0]; i <= box.hi[0]; ++i) {
          for (int64_t j = box.lo[1]; j <= box.hi[1]; ++j) {
            for (int64_t k = box.lo[2]; k <= box.hi[2]; ++k) {
              const Int3 z{i, j, k};
              Point w;
              for (size_t a = 0; a < 3; ++a) w[a] = kUnitsPerVoxel * z[a] - v0[a];
              const mpq_class u = determinant(w, e2, back) / all;
              if (u < 0 || u > 1) continue;
              const mpq_class v = determinant(e1, w, back) / all;
              if (v < 0 || u + v > 1) continue;
              const mpq_class s = determinant(e1, e2, w) / all;
              // z is an end of the crossed edge, on either side.
              if (abs(s) >= 1) continue;
              const int64_t step = sgn(s);
              const Int3 other{z[0] + step * q[0], z[1] + step * q[1], z[2] + step * q[2]};
              const bool z_is_near = 2 * abs(s) < 1;
              if (z_is_near) expected.insert({z, other});
              if (!z_is_near && !box.Contains(other)) expected.insert({other, z});
            }
          }
        }
      }
      for (const Crossing& crossing : Crossings(mesh.triangles, q, box)) {
        found.insert({crossing.near_end, crossing.far_end});
      }
      EXPECT_EQ(found, expected);
    }
  }
}

TEST(Crossings, DoNotDependOnTheOrderOfTrianglesOrVerticesOrOnTheSignOfTheDirection) {
  const auto directions = CartesianDirections();
  const auto sorted = [](const std::vector<Crossing>& crossings, int sign) {
    std::multiset<std::tuple<Int3, Int3, int>> all;
    for (const Crossing& c : crossings) all.insert({c.near_end, c.far_end, sign * c.orientation});
    return all;
  };
  for (const NamedMesh& mesh : AdversarialMeshes(kSeed, directions)) {
    if (mesh.triangles.size() > 40 || mesh.name.starts_with("plane/")) continue;
    SCOPED_TRACE(mesh.name);
    Mesh turned(mesh.triangles.rbegin(), mesh.triangles.rend());
    for (Triangle& t : turned) std::rotate(t.begin(), t.begin() + 1, t.end());
    Mesh reversed = turned;
    for (Triangle& t : reversed) std::swap(t[0], t[2]);
    for (const Int3& q : directions) {
      const auto plain = sorted(Crossings(mesh.triangles, q, mesh.box), 1);
      EXPECT_EQ(sorted(Crossings(turned, q, mesh.box), 1), plain);
      EXPECT_EQ(sorted(Crossings(reversed, q, mesh.box), -1), plain);
      EXPECT_EQ(sorted(Crossings(mesh.triangles, {-q[0], -q[1], -q[2]}, mesh.box), -1), plain);
    }
  }
}

TEST(Digitize, CoversEveryCrossedEdgeAndIsMinimalOnRequest) {
  for (const auto& [lattice, directions] : DirectionSets()) {
    for (const NamedMesh& mesh : AdversarialMeshes(kSeed, directions)) {
      const bool slow =
          mesh.name == "tiny/fine_sphere" || (mesh.name.starts_with("plane/") && !mesh.name.ends_with("_at_128"));
      if (mesh.box || (slow && lattice != "cartesian_k0")) continue;
      SCOPED_TRACE(lattice + " " + mesh.name);
      const auto crossed = CrossedEdges(mesh.triangles, directions);
      const auto voxels = Digitize(mesh.triangles, directions, false);
      EXPECT_EQ(Tunnels(voxels, crossed), 0u);
      const auto minimal = Digitize(mesh.triangles, directions, true);
      EXPECT_EQ(Tunnels(minimal, crossed), 0u);
      EXPECT_EQ(Redundant(minimal, crossed), 0u);
      EXPECT_TRUE(std::includes(voxels.begin(), voxels.end(), minimal.begin(), minimal.end()));
    }
  }
}

TEST(Digitize, InABoxIsTheWholeResultCutToTheBox) {
  const Box box{{-1, -2, 0}, {2, 1, 1}};
  for (const auto& [lattice, directions] : DirectionSets()) {
    if (!lattice.starts_with("bcc") && !lattice.starts_with("cartesian")) continue;
    for (const NamedMesh& mesh : AdversarialMeshes(kSeed, directions)) {
      if (mesh.box || !(mesh.name.starts_with("soup/") || mesh.name.starts_with("leaves/"))) continue;
      SCOPED_TRACE(lattice + " " + mesh.name);
      for (bool minimal : {false, true}) {
        auto whole = Digitize(mesh.triangles, directions, minimal);
        std::erase_if(whole, [&box](const Int3& z) { return !box.Contains(z); });
        EXPECT_EQ(Digitize(mesh.triangles, directions, minimal, box), whole);
      }
    }
  }
}

TEST(Digitize, OfAPlaneIsThePlaneSetThinnedOrNot) {
  const Box box{{-3, -3, -3}, {3, 3, 3}};
  const Int3 normals[] = {{1, 0, 0},   {0, 0, -1}, {1, 1, 0}, {-1, 1, 0},  {0, 1, -1}, {1, 1, 1},
                          {-1, 1, -1}, {1, 2, 0},  {1, 2, 3}, {-2, 1, -1}, {0, -1, 3}, {17, 1, -40}};
  for (const auto& [lattice, directions] : DirectionSets()) {
    for (const Int3& normal : normals) {
      for (int64_t offset : {0, 128, -128, 256, 384, 1, -77}) {
        SCOPED_TRACE(lattice + " " + testing::PrintToString(normal) + " " + std::to_string(offset));
        const auto expected = PlaneSet(normal, offset, directions, box);
        const Mesh plane = PlaneQuad(normal, offset, 80 * kUnitsPerVoxel);
        EXPECT_EQ(Digitize(plane, directions, false, box), expected);
        if (offset == 128) {
          EXPECT_EQ(Digitize(plane, directions, true, box), expected);
        }
      }
    }
  }
}

// A plane has exactly one voxel on every line along the direction that attains t.
TEST(PlaneSet, HoldsOneVoxelOfEveryPrincipalLine) {
  const auto directions = CartesianDirections();
  const auto voxels = PlaneSet({1, 1, 1}, 128, directions, {{-6, -6, -6}, {6, 6, 6}});
  for (int64_t i = -1; i <= 1; ++i) {
    for (int64_t j = -1; j <= 1; ++j) {
      const Int3 line = LineOf({i, j, 0}, {1, 1, 1});
      EXPECT_EQ(std::count_if(voxels.begin(), voxels.end(),
                              [&](const Int3& z) {
                                return LineOf(z, {1, 1, 1}) == line;
                              }),
                1);
    }
  }
}

}  // namespace
}  // namespace latvox::oracle
