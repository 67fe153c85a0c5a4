// Meshes and their one rounding.
#include "core/snap/snap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "core/base/stop_signal.h"
#include "core/snap/mesh_range.h"
#include "tests/unit/core/simd.h"

namespace latvox {
namespace {

const Lattice& Cartesian() {
  static const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  return lattice;
}

TriangleMesh OneTriangle(const Vec3f& a, const Vec3f& b, const Vec3f& c) { return {{a, b, c}, {{0, 1, 2}}}; }

Vec3i GlobalUnits(const SnappedMesh& mesh, size_t vertex) {
  return mesh.vertices_lat[vertex] + mesh.base_ijk * kLatticeUnit;
}

TEST(Mesh, ValidationNamesTheElement) {
  TriangleMesh mesh = OneTriangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  EXPECT_TRUE(CheckMesh(mesh).ok());
  mesh.vertices.push_back({0, NAN, 0});
  for (const float x : {NAN, -NAN, INFINITY, -INFINITY}) {
    mesh.vertices.back()[1] = x;
    EXPECT_EQ(CheckMesh(mesh).message(), "mesh: vertex 3 is not finite");
  }
  for (const float x : {FLT_MAX, -FLT_MAX, FLT_TRUE_MIN, -0.0F}) {
    mesh.vertices.back()[1] = x;
    EXPECT_TRUE(CheckMesh(mesh).ok()) << x;
  }
  mesh.vertices.pop_back();
  mesh.triangles.push_back({0, 1, 3});
  EXPECT_EQ(CheckMesh(mesh).message(), "mesh: triangle 1 uses vertex 3 of 3");
  mesh.triangles.back() = {0, UINT32_MAX, 1};
  EXPECT_EQ(CheckMesh(mesh).message(), "mesh: triangle 1 uses vertex 4294967295 of 3");
  mesh.vertices.clear();
  EXPECT_EQ(CheckMesh(mesh).message(), "mesh: triangle 0 uses vertex 0 of 0");
  mesh.triangles.clear();
  EXPECT_EQ(CheckMesh(mesh).message(), "mesh: it has no triangles");
}

TEST(Mesh, BoundsIgnoreVerticesThatNoTriangleUses) {
  TriangleMesh mesh = OneTriangle({-1, 2, 3}, {4, 5, 6}, {0, 0, 0});
  mesh.vertices.push_back({1000, 1000, 1000});
  const Bounds bounds = BoundsOf(mesh);
  EXPECT_EQ(bounds.min, (Vec3d{-1, 0, 0}));
  EXPECT_EQ(bounds.max, (Vec3d{4, 5, 6}));
  EXPECT_EQ(bounds.LongestSide(), 6);
}

TEST(Snap, RoundsHalfToEvenInUnitsOfAVoxels256thPart) {
  const float half = 0.5F / 256;
  const auto snapped =
      Snap(OneTriangle({half, 3 * half, -half}, {5, -3 * half, 2}, {1, 1, 0.3F}), Cartesian(), {0, 0, 0}, {1, 1, 1});
  ASSERT_TRUE(snapped.ok());
  EXPECT_EQ(GlobalUnits(*snapped, 0), (Vec3i{0, 2, 0}));
  EXPECT_EQ(GlobalUnits(*snapped, 1), (Vec3i{5 * 256, -2, 512}));
  EXPECT_EQ(GlobalUnits(*snapped, 2), (Vec3i{256, 256, 77}));
}

TEST(Snap, MovesNoVertexByMoreThanTheStatedBound) {
  constexpr unsigned kSeed = 11;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> coordinate(-40, 40);
  TriangleMesh mesh;
  for (uint32_t n = 0; n < 3000; ++n) {
    mesh.vertices.push_back({coordinate(random), coordinate(random), coordinate(random)});
    if (n % 3 == 2) mesh.triangles.push_back({n - 2, n - 1, n});
  }
  for (NamedLattice name :
       {NamedLattice::kCartesian, NamedLattice::kBcc, NamedLattice::kFcc, NamedLattice::kHexagonal}) {
    const Lattice lattice = *Lattice::Named(name).Scaled(0.0173);
    const Vec3d origin{0.5, -7, 11};
    const auto snapped = Snap(mesh, lattice, origin, {1, 1, 1});
    ASSERT_TRUE(snapped.ok()) << snapped.status();
    for (size_t n = 0; n < mesh.vertices.size(); ++n) {
      const Vec3f& p = mesh.vertices[n];
      const Vec3d exact = Apply(lattice.inverse(), Vec3d{p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]});
      for (size_t m = 0; m < 3; ++m) {
        EXPECT_LE(std::abs(GlobalUnits(*snapped, n)[m] / 256.0 - exact[m]), kSnapErrorMax * (1 + 1e-6)) << kSeed;
      }
    }
  }
}

// The mesh with doubles in place of floats, moved.
TriangleMesh Doubled(const TriangleMesh& mesh, const Vec3d& by) {
  TriangleMesh doubled{{}, mesh.triangles};
  for (const Vec3f& p : mesh.vertices) doubled.double_vertices.push_back({p[0] + by[0], p[1] + by[1], p[2] + by[2]});
  return doubled;
}

TEST(Snap, DoublesFarFrom0GiveTheSameUnitsAsFloatsAt0) {
  std::mt19937 random(5);
  std::uniform_int_distribution<int> coordinate(-(1 << 20), 1 << 20);
  TriangleMesh mesh;
  for (uint32_t n = 0; n < 3001; ++n) {
    Vec3f p;
    for (float& x : p) x = std::ldexp(static_cast<float>(coordinate(random)), -20);
    mesh.vertices.push_back(p);
    if (n % 3 == 2) mesh.triangles.push_back({n - 2, n - 1, n});
  }
  const Vec3d by{691603.5, 5334762.25, 519.75}, origin{0.25, -0.5, 0.125};
  const TriangleMesh far = Doubled(mesh, by);
  EXPECT_TRUE(CheckMesh(far).ok());
  EXPECT_EQ(BoundsOf(far).min, BoundsOf(mesh).min + by);
  for (NamedLattice name :
       {NamedLattice::kCartesian, NamedLattice::kBcc, NamedLattice::kFcc, NamedLattice::kHexagonal}) {
    const Lattice lattice = *Lattice::Named(name).Scaled(0.0173);
    const auto near = Snap(mesh, lattice, origin, {1, 1, 1});
    const auto moved = Snap(far, lattice, origin + by, {1, 1, 1});
    const auto shared = Snap(std::make_shared<const TriangleMesh>(far), lattice, origin + by, {1, 1, 1});
    ASSERT_TRUE(near.ok() && moved.ok() && shared.ok()) << moved.status();
    EXPECT_EQ(moved->base_ijk, near->base_ijk);
    for (size_t n = 0; n < mesh.vertices.size(); ++n) {
      EXPECT_EQ(moved->vertices_lat[n], near->vertices_lat[n]);
      EXPECT_EQ(shared->vertices_lat[n], near->vertices_lat[n]);
    }
  }
}

TEST(Snap, MovesNoDoubleByMoreThanTheStatedBound) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> coordinate(-40, 40);
  TriangleMesh mesh;
  for (uint32_t n = 0; n < 1000; ++n) {
    mesh.double_vertices.push_back({coordinate(random), coordinate(random), coordinate(random)});
  }
  for (uint32_t n = 2; n < 1000; ++n) mesh.triangles.push_back({n - 2, n - 1, n});
  const Lattice lattice = *Lattice::Named(NamedLattice::kFcc).Scaled(0.0173);
  const auto all = Snap(mesh, lattice, {}, {1, 1, 1});
  ASSERT_TRUE(all.ok());
  for (size_t n = 0; n < 1000; ++n) {
    const Vec3d exact = Apply(lattice.inverse(), mesh.double_vertices[n]);
    for (size_t m = 0; m < 3; ++m) {
      EXPECT_LE(std::abs(GlobalUnits(*all, n)[m] / 256.0 - exact[m]), kSnapErrorMax * (1 + 1e-6));
    }
  }
}

TEST(Mesh, ANumberThatIsNotFiniteIsNamedAmongDoubles) {
  TriangleMesh mesh = Doubled(OneTriangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), {});
  for (const double x : {HUGE_VAL, -HUGE_VAL, std::nan("")}) {
    mesh.double_vertices[1][2] = x;
    EXPECT_EQ(CheckMesh(mesh).message(), "mesh: vertex 1 is not finite");
  }
  mesh.double_vertices[1][2] = 1e300;
  EXPECT_TRUE(CheckMesh(mesh).ok());
}

TEST(Snap, BaseIsTileAlignedAndVerticesAreNotNegative) {
  const auto snapped =
      Snap(OneTriangle({-130, -64, 0}, {5, -0.001F, 63}, {64, 65, 1e-9F}), Cartesian(), {0, 0, 0}, {1, 1, 1});
  ASSERT_TRUE(snapped.ok());
  EXPECT_EQ(snapped->base_ijk, (Vec3i{-192, -128, -64}));
  for (const Vec3i& v : snapped->vertices_lat) {
    for (int32_t x : v) EXPECT_GE(x, 0);
  }
}

TEST(Snap, AcceptsTheLargestExtentAndRefusesOneMore) {
  const auto at = [](float size) {
    return Snap(OneTriangle({0, 0, 0}, {1, size, 0}, {0, 1, 1}), Cartesian(), {0, 0, 0}, {1, 1, 1});
  };
  EXPECT_TRUE(at(kMaxExtent - 1).ok());
  const auto refused = at(kMaxExtent);
  EXPECT_EQ(refused.status().message(),
            "voxel_size: at 1 the mesh extends over 131073 voxels on lattice axis j, the limit is 131072");
  EXPECT_EQ(refused.status().code(), absl::StatusCode::kResourceExhausted);
}

TEST(Snap, RefusesPositionsThatOverflow) {
  const auto snapped = Snap(OneTriangle({0, 0, 0}, {1, 0, 0}, {0, 1, 1}), Cartesian(), {0, 0, -1e10}, {1, 1, 1});
  EXPECT_EQ(snapped.status().message(),
            "origin: it puts the mesh at lattice coordinate 1e+10 on axis k, the limit is 536870912");
  EXPECT_EQ(snapped.status().code(), absl::StatusCode::kInvalidArgument);
  // The mesh is too large as well, and no origin would help. So the error blames the voxel size.
  const auto fine =
      Snap(OneTriangle({0, 0, 0}, {1, 0, 0}, {0, 1, 1}), Cartesian().Scaled(0x1p-30).value(), {0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(
      fine.status().message(),
      "voxel_size: at 9.31323e-10 the mesh extends over 1073741825 voxels on lattice axis i, the limit is 131072");
}

TEST(Snap, FarOriginGivesTheSameMeshAtShiftedCoordinates) {
  const TriangleMesh mesh = OneTriangle({0.25F, 0.5F, 3}, {9, 2.125F, 0}, {0, 7, 1});
  const auto near = Snap(mesh, Cartesian(), {0, 0, 0}, {1, 1, 1});
  const auto far = Snap(mesh, Cartesian(), {-64e6, 64e6, 0}, {1, 1, 1});
  ASSERT_TRUE(near.ok() && far.ok());
  EXPECT_TRUE(std::ranges::equal(near->vertices_lat, far->vertices_lat));
  EXPECT_EQ(far->base_ijk, near->base_ijk + (Vec3i{64000000, -64000000, 0}));
}

TEST(Snap, EveryKernelRoundsAsTheOneExpressionDoes) {
  constexpr unsigned kSeed = 13;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> coordinate(-90, 90);
  for (uint32_t count : {3U, 4U, 5U, 7U, 8U, 9U, 1001U, 20000U, 180001U}) {  // the last in large pages
    TriangleMesh mesh;
    for (uint32_t n = 0; n < count; ++n) {
      mesh.vertices.push_back({coordinate(random), coordinate(random), coordinate(random)});
      if (n % 3 == 0) mesh.vertices.back()[n / 3 % 3] = static_cast<float>(static_cast<int>(random() % 999)) / 512;
      if (n >= 2) mesh.triangles.push_back({n - 2, n - 1, n});
    }
    const Lattice lattice = *Lattice::Named(NamedLattice::kFcc).Scaled(0.37);
    const Vec3d origin{0.1, -3, 7};
    const Mat3d& inverse = lattice.inverse();
    WithEachSimd([&] {
      const auto snapped = Snap(mesh, lattice, origin, {1, 1, 1});
      ASSERT_TRUE(snapped.ok()) << snapped.status();
      for (size_t n = 0; n < count; ++n) {
        const Vec3f& p = mesh.vertices[n];
        const Vec3d d{p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]};
        for (size_t m = 0; m < 3; ++m) {
          const double v = (inverse[0][m] * d[0] + inverse[1][m] * d[1]) + inverse[2][m] * d[2];
          ASSERT_EQ(GlobalUnits(*snapped, n)[m], static_cast<int32_t>(std::nearbyint(v * kLatticeUnit))) << kSeed;
        }
      }
      // A mesh with other owners is rounded into new memory.
      const auto kept = std::make_shared<const TriangleMesh>(mesh);
      const auto shared = Snap(kept, lattice, origin, {1, 1, 1});
      ASSERT_TRUE(shared.ok()) << shared.status();
      EXPECT_TRUE(std::ranges::equal(shared->vertices_lat, snapped->vertices_lat));
      EXPECT_EQ(kept->vertices, mesh.vertices);
    });
  }
}

// Compilers may fuse a product with a sum, on ARM and in kernels for AVX2, unless an option forbids it.
TEST(Snap, RoundsEachProductAndEachSumOnEveryProcessor) {
  constexpr unsigned kSeed = 29;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> number(-90, 90);
  const auto vector = [&] { return Vec3d{number(random), number(random), number(random)}; };
  for (int n = 0; n < 100; ++n) {
    const LatticeMap map{{vector(), vector(), vector()}, {0, 0, 0}};
    const Vec3d p = vector();
    Vec3d expected;
    for (size_t m = 0; m < 3; ++m) {
      const volatile double a = map.inverse[0][m] * p[0], b = map.inverse[1][m] * p[1], c = map.inverse[2][m] * p[2];
      const volatile double sum = a + b;
      expected[m] = sum + c;
    }
    const std::vector<Vec3d> copies(9, p);  // some in vectors, one alone
    WithEachSimd([&] {
      const LatticeRange range = RangeOf(map, copies.data(), copies.size());
      EXPECT_EQ(range.min, expected) << kSeed;
      EXPECT_EQ(range.max, expected) << kSeed;
    });
  }
}

TEST(Snap, TakesTheMemoryOfAMeshThatIsHandedOver) {
  TriangleMesh mesh = OneTriangle({0, 0, 0}, {5, 0, 0}, {0, 7, 1});
  const void* const vertices = mesh.vertices.data();
  const void* const triangles = mesh.triangles.data();
  auto snapped = Snap(std::move(mesh), Cartesian(), {0, 0, 0}, {1, 1, 1});
  ASSERT_TRUE(snapped.ok());
  EXPECT_EQ(snapped->vertices_lat.data(), vertices);
  EXPECT_EQ(snapped->triangles.data(), triangles);
  // A copy of the array keeps the memory.
  const auto vertices_lat = snapped->vertices_lat;
  *snapped = {};
  EXPECT_EQ(vertices_lat[1], (Vec3i{69, 64, 64}) * kLatticeUnit);
}

TEST(Snap, VerticesThatNoTriangleUsesChangeNothingWhereverTheyAre) {
  constexpr unsigned kSeed = 17;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> coordinate(-30, 30);
  TriangleMesh plain, crowded;
  for (uint32_t n = 0; n < 999; ++n) {
    const Vec3f p{coordinate(random), coordinate(random), coordinate(random)};
    plain.vertices.push_back(p);
    for (float far : {1e30F, -1e30F, 3e38F}) {
      if (random() % 3 == 0) crowded.vertices.push_back({far, random() % 2 == 0 ? -far : 0, far});
    }
    crowded.vertices.push_back(p);
    if (n % 3 != 2) continue;
    plain.triangles.push_back({n - 2, n - 1, n});
    crowded.triangles.push_back({});
  }
  std::vector<uint32_t> used;
  for (uint32_t n = 0; n < crowded.vertices.size(); ++n) {
    if (std::abs(crowded.vertices[n][0]) < 100) used.push_back(n);
  }
  for (size_t n = 0; n < used.size(); ++n) crowded.triangles[n / 3][n % 3] = used[n];
  WithEachSimd([&] {
    const Lattice bcc = Lattice::Named(NamedLattice::kBcc);
    const auto expected = Snap(plain, bcc, {0, 0, 0}, {1, 1, 1}), snapped = Snap(crowded, bcc, {0, 0, 0}, {1, 1, 1});
    ASSERT_TRUE(expected.ok() && snapped.ok());
    EXPECT_EQ(snapped->base_ijk, expected->base_ijk);
    EXPECT_EQ(snapped->box, expected->box);
    for (size_t n = 0; n < used.size(); ++n) {
      ASSERT_EQ(snapped->vertices_lat[used[n]], expected->vertices_lat[n]) << kSeed;
    }
  });
}

// A bumpy sheet whose vertices are numbered as its triangles come.
TriangleMesh Sheet() {
  constexpr unsigned kSeed = 18;
  constexpr uint32_t kSide = 180;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> bump(-20, 20);
  TriangleMesh sheet;
  for (uint32_t n = 0; n < kSide * kSide; ++n) {
    sheet.vertices.push_back({static_cast<float>(n / kSide) - 90, static_cast<float>(n % kSide), bump(random)});
    if (n / kSide + 1 == kSide || n % kSide + 1 == kSide) continue;
    sheet.triangles.push_back({n, n + 1, n + kSide});
    sheet.triangles.push_back({n + 1, n + kSide + 1, n + kSide});
  }
  return sheet;
}

TEST(Snap, TheRangeIsThatOfUsedVerticesHoweverTheyAreNumbered) {
  constexpr unsigned kSeed = 23;
  std::mt19937 random(kSeed);
  const TriangleMesh sheet = Sheet();
  const Lattice bcc = *Lattice::Named(NamedLattice::kBcc).Scaled(0.7);
  const Vec3d origin{-0.3, 4, 0};
  const auto expected = Snap(sheet, bcc, origin, {1, 1, 1});
  ASSERT_TRUE(expected.ok());
  const auto expect_same_range = [&](const TriangleMesh& mesh) {
    WithEachSimd([&] {
      const auto snapped = Snap(mesh, bcc, origin, {1, 1, 1});
      ASSERT_TRUE(snapped.ok()) << snapped.status();
      EXPECT_EQ(snapped->base_ijk, expected->base_ijk);
      EXPECT_EQ(snapped->box, expected->box);
    });
  };
  TriangleMesh shuffled = sheet;
  std::shuffle(shuffled.triangles.begin(), shuffled.triangles.end(), random);
  expect_same_range(shuffled);
  // One unused vertex, beyond or beside each used one, at either end or in the middle.
  const auto with_unused = [](TriangleMesh mesh, size_t at, const Vec3f& position) {
    mesh.vertices.insert(mesh.vertices.begin() + static_cast<ptrdiff_t>(at), position);
    for (auto& triangle : mesh.triangles) {
      for (uint32_t& index : triangle) index += index >= at ? 1 : 0;
    }
    return mesh;
  };
  const size_t count = sheet.vertices.size();
  for (const TriangleMesh* mesh : {&sheet, &std::as_const(shuffled)}) {
    for (const size_t at : {size_t{0}, count / 2, count}) {
      for (size_t m = 0; m < 3; ++m) {
        Vec3f position{};
        for (const float far : {-1000.0F, 1000.0F}) {
          position[m] = far;
          expect_same_range(with_unused(*mesh, at, position));
        }
        const auto by_axis = [m](const Vec3f& a, const Vec3f& b) { return a[m] < b[m]; };
        const auto [least, most] = std::minmax_element(sheet.vertices.begin(), sheet.vertices.end(), by_axis);
        expect_same_range(with_unused(*mesh, at, *least));
        expect_same_range(with_unused(*mesh, at, *most));
      }
    }
  }
  // An extreme of its own, used by one triangle alone, far from where others use such numbers.
  const std::vector<uint32_t> numbers{0, static_cast<uint32_t>(count) / 2, static_cast<uint32_t>(count)};
  for (const uint32_t number : numbers) {
    for (const size_t at : {size_t{0}, sheet.triangles.size() / 2, sheet.triangles.size()}) {
      TriangleMesh mesh = with_unused(sheet, number, {0, 1000, 0});
      const std::array<uint32_t, 3> triangle{number, number == 0 ? 1U : 0U, 2};
      mesh.triangles.insert(mesh.triangles.begin() + static_cast<ptrdiff_t>(at), triangle);
      TriangleMesh last = sheet;
      last.vertices.push_back({0, 1000, 0});
      last.triangles.push_back({0, 1, static_cast<uint32_t>(count)});
      const auto reached = Snap(last, bcc, origin, {1, 1, 1}), snapped = Snap(mesh, bcc, origin, {1, 1, 1});
      ASSERT_TRUE(reached.ok() && snapped.ok());
      EXPECT_EQ(snapped->box, reached->box);
      EXPECT_NE(snapped->box, expected->box);
    }
  }
}

TEST(Snap, SaysSoWhereItWasCancelled) {
  StopSource source;
  source.Stop();
  EXPECT_TRUE(absl::IsCancelled(Snap(Sheet(), Cartesian(), {0, 0, 0}, {1, 1, 1}, source.Signal()).status()));
}

}  // namespace
}  // namespace latvox
