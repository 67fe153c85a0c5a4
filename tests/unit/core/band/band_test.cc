// The points, distances and signs of a band, compared with rational arithmetic that shares only the metric with it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "core/band/plan.h"
#include "core/digitize/crossing.h"
#include "core/snap/snap.h"
#include "core/voxelizer/estimate.h"
#include "tests/unit/core/distance.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/fields.h"
#include "tests/unit/core/sphere.h"

namespace latvox {
namespace {

using testing::HasSubstr;
using Values = std::map<Vec3i, float>;

Values ValuesOf(const Result& result) { return DistancesOf(result.tiles); }

// Asks for the band's distances.
VoxelizeOptions With(const Band& band, bool is_signed = false) {
  return {.set = band, .fields = {Field::kDistance}, .signed_distance = is_signed};
}

// Small triangles, and kinds that provoke errors: in a lattice plane, with equal corners, on a line, slivers.
std::vector<oracle::Mesh> SmallMeshes(unsigned seed) {
  std::mt19937 random(seed);
  const auto corner = [&](int64_t step) {
    oracle::Int3 v;
    for (int64_t& x : v) x = static_cast<int64_t>(random() % (3 * 256)) / step * step;
    return v;
  };
  const oracle::Int3 a = corner(1), b = corner(1);
  const oracle::Int3 middle{(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2};
  return {{{corner(1), corner(1), corner(1)}, {corner(1), corner(1), corner(1)}},
          {{corner(256), corner(256), corner(256)}, {corner(128), corner(128), corner(128)}},
          {{oracle::Int3{0, 0, 512}, oracle::Int3{768, 0, 512}, oracle::Int3{0, 768, 512}}},
          {{a, a, a}, {b, a, b}},
          {{oracle::Int3{0, 0, 0}, oracle::Int3{384, 384, 192}, oracle::Int3{768, 768, 384}}, {a, b, middle}},
          {{oracle::Int3{0, 0, 0}, oracle::Int3{765, 766, 767}, oracle::Int3{382, 383, 384}}}};
}

void ExpectExactBand(const oracle::Mesh& shape, const Lattice& lattice, const Band& band) {
  const TriangleMesh mesh = ToWorld(shape, lattice);
  const BandPlan plan = MakeBandPlan(band, lattice).value();
  const SnappedMesh snapped = Snap(mesh, lattice, {0, 0, 0}, plan.reach * 2).value();
  Values values = ValuesOf(Voxelize(mesh, Unscaled(lattice), With(band)));
  size_t found = 0;
  const IndexBox& box = snapped.box;
  for (int32_t i = box.min[0] - 1; i <= box.max[0]; ++i) {
    for (int32_t j = box.min[1] - 1; j <= box.max[1]; ++j) {
      for (int32_t k = box.min[2] - 1; k <= box.max[2]; ++k) {
        const Vec3i local{i, j, k};
        Rational least = -1;
        for (const auto& [a, b, c] : snapped.triangles) {
          const Rational square = SquareTo(plan.metric.g, local * kLatticeUnit,
                                           {snapped.vertices_lat[a], snapped.vertices_lat[b], snapped.vertices_lat[c]});
          if (least < 0 || square < least) least = square;
        }
        const auto value = values.find(local + snapped.base_ijk);
        ASSERT_EQ(value != values.end(), least <= Rational(plan.limit)) << i << ' ' << j << ' ' << k;
        if (value == values.end()) continue;
        ++found;
        const long double exact =
            std::sqrt(least.convert_to<long double>() / static_cast<long double>(plan.metric.one)) *
            static_cast<long double>(lattice.voxel_size() / kLatticeUnit);
        const float lower = std::nextafter(value->second, -1.0F), upper = std::nextafter(value->second, 1e30F);
        EXPECT_GE(value->second, 0);
        EXPECT_LT(lower, exact * (1 + 1e-15L) + 1e-30L);
        EXPECT_GT(upper, exact * (1 - 1e-15L));
        EXPECT_EQ(value->second == 0, least == 0);
      }
    }
  }
  EXPECT_EQ(found, values.size());
  EXPECT_GT(found, 0U);
}

TEST(Band, HoldsExactlyThePointsWithinTheWidthWithTheirDistances) {
  const std::vector<Lattice> lattices = Lattices();
  for (size_t seed = 0; seed < lattices.size(); ++seed) {
    const std::vector<oracle::Mesh> shapes = SmallMeshes(static_cast<unsigned>(seed));
    for (size_t n = seed % 2; n < shapes.size(); n += Dose(2, 4)) {
      SCOPED_TRACE(testing::Message() << lattices[seed].name() << " seed " << seed << " mesh " << n);
      ExpectExactBand(shapes[n], lattices[seed], {.width = n % 3 == 0 ? 1.0 : 1.5, .in_voxels = true});
    }
  }
}

// Long triangles through many tiles, and a band wider than a tile's usual margin.
TEST(Band, IsExactFarFromATrianglesCorners) {
  const Lattice lattice = Lattice::FromBasis({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}).value();
  const oracle::Mesh mesh{{oracle::Int3{0, 0, 0}, oracle::Int3{70 * 256 + 1, 5, 130}, oracle::Int3{40 * 256, 3, 131}}};
  ExpectExactBand(mesh, lattice, {.width = 2});
}

TEST(Band, MeasuresByProductsOfTheBasis) {
  for (const Lattice& lattice : Lattices()) {
    const Metric metric = MakeMetric(lattice).value();
    const double size = lattice.voxel_size();
    for (size_t r = 0; r < 3; ++r) {
      for (size_t c = 0; c < 3; ++c) {
        const double product = Dot(lattice.basis()[r], lattice.basis()[c]) / (size * size);
        EXPECT_NEAR(static_cast<double>(metric.g[c][r]), product * metric.one, 0.51);
      }
    }
    EXPECT_GT(metric.one, 0x1p39);
    EXPECT_LE(metric.one, 0x1p40);
  }
}

// Pairs of vectors with equal lengths from different products, and bands with these lengths as widths.
TEST(Band, MeasuresEqualLengthsAsEqual) {
  struct Case {
    Mat3d basis;
    Vec3i u, v;
    double length;
  };
  const double root = std::sqrt(0.75);
  for (const auto& [basis, u, v, length] :
       {Case{{{{2, 0, 0}, {0, 2, 0}, {1, 1, 1}}}, {1, 0, 0}, {-1, -1, 2}, 2},
        Case{{{{1, 1, 0}, {1, 0, 1}, {0, 1, 1}}}, {1, 1, -1}, {1, -1, 1}, 2},
        Case{{{{1, 0, 0}, {0.5, root, 0}, {0, 0, 1}}}, {-1, 2, 0}, {1, 1, 0}, 2 * root},
        Case{{{{7, 0, 0}, {0, 5, 0}, {1, 2, 3}}}, {-1, 0, 1}, {1, 0, 0}, 7}}) {
    for (const double scale : {1.0, 0.1, 1 / 3.0, 1e-6, 12345.678}) {
      const Lattice lattice = Lattice::FromBasis({basis[0] * scale, basis[1] * scale, basis[2] * scale}).value();
      const Metric metric = MakeMetric(lattice).value();
      const Vec3i along_u = u * kLatticeUnit, along_v = v * kLatticeUnit;
      const auto square = Rational(Inner(metric, along_u, along_u));
      EXPECT_EQ(square, Rational(Inner(metric, along_v, along_v))) << basis[2][2] << " times " << scale;
      for (const int32_t times : {1, 30}) {
        const Rational limit(MakeBandPlan({.width = times * length * scale}, lattice)->limit);
        const Rational exact = square * times * times;
        EXPECT_GE(limit, exact) << basis[2][2] << " times " << scale;
        EXPECT_LT((limit - exact).convert_to<double>(), 0x1p-45 * exact.convert_to<double>());
      }
    }
  }
}

// The plane lies at 0, and planes of voxels at multiples of a voxel size that no double equals.
TEST(Band, IsClosedAndTiesAreIn) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian).Scaled(0.1).value();
  const oracle::Mesh mesh{{oracle::Int3{0, 0, 0}, oracle::Int3{2048, 0, 0}, oracle::Int3{0, 2048, 0}}};
  for (const Band& band : {Band{.width = 0.3}, Band{.width = 3, .in_voxels = true}}) {
    const Values values = ValuesOf(Voxelize(ToWorld(mesh, lattice), Unscaled(lattice), With(band)));
    EXPECT_EQ(values.at({2, 2, 3}), 0.3F);
    EXPECT_EQ(values.at({2, 2, -3}), 0.3F);
    EXPECT_EQ(values.at({2, 2, 0}), 0.0F);
    EXPECT_EQ(values.count({2, 2, 4}), 0U);
    EXPECT_EQ(values.at({-3, 2, 0}), 0.3F);
    EXPECT_EQ(values.count({-3, 2, 1}), 0U);
  }
  const Values below = ValuesOf(Voxelize(ToWorld(mesh, lattice), Unscaled(lattice), With(Band{.width = 0.29999})));
  EXPECT_EQ(below.count({2, 2, 3}), 0U);
}

// Lattices whose products have no small common denominator, and lengths that no double equals.
TEST(Band, WhatLiesAtTheWidthIsInOnAnyLattice) {
  const oracle::Mesh point{{oracle::Int3{0, 0, 0}, oracle::Int3{0, 0, 0}, oracle::Int3{0, 0, 0}}};
  for (const Mat3d& basis : {Mat3d{{{0.75, 0, 0}, {0, 0.75, 0}, {0, 0, 4.57}}},
                             {{{33, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
                             {{{1.1, 0.3, 0}, {0, 1.7, 0.2}, {0.1, 0, 2.3}}}}) {
    const Lattice lattice = Lattice::FromBasis(basis).value();
    for (const Vec3i& v : {Vec3i{2, 0, 0}, Vec3i{0, 2, 0}, Vec3i{0, 0, 3}, Vec3i{1, -1, 0}, Vec3i{2, 1, -1}}) {
      const Vec3d world = Apply(lattice.basis(), ToDouble(v));
      const Band band{.width = std::sqrt(Dot(world, world))};
      const Values values = ValuesOf(Voxelize(ToWorld(point, lattice), Unscaled(lattice), With(band)));
      EXPECT_EQ(values.count(v) + values.count(-v), 2U) << basis[0][0] << " width " << band.width;
    }
  }
  const Lattice cartesian = Lattice::Named(NamedLattice::kCartesian);
  const oracle::Mesh plane{
      {oracle::Int3{-5120, -2560, 5120}, oracle::Int3{5120, -2560, 0}, oracle::Int3{0, 5120, -5120}}};
  for (const double width : {5 / 3.0, std::nextafter(5 / 3.0, 0.0)}) {  // of the plane x + 2y + 2z = 0
    const Values values =
        ValuesOf(Voxelize(ToWorld(plane, cartesian), Unscaled(cartesian), With(Band{.width = width})));
    EXPECT_EQ(values.count({1, 1, 1}), 1U);
    EXPECT_EQ(values.count({0, 2, 1}), 0U);
  }
}

TEST(Band, IsRefusedFarBelowAVoxel) {
  const Lattice lattice = Lattice::Named(NamedLattice::kBcc);
  EXPECT_TRUE(MakeBandPlan({.width = 0x1p-13}, lattice).ok());
  EXPECT_EQ(MakeBandPlan({.width = 1e-4}, lattice).status().message(),
            "band: a width of 0.0001 is below 1/8192 of the voxel size 1");
}

void AddBox(int32_t low, int32_t high, oracle::Mesh& mesh) {
  const auto corner = [&](size_t bits) {
    return oracle::Int3{bits & 4 ? high : low, bits & 2 ? high : low, bits & 1 ? high : low};
  };
  for (const auto& [a, b, c, d] : std::vector<std::array<size_t, 4>>{
           {0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}) {
    mesh.push_back({corner(a), corner(b), corner(c)});
    mesh.push_back({corner(a), corner(c), corner(d)});
  }
}

// A shell in a shell, with faces in lattice planes, around the corner of eight tiles.
TEST(SignedBand, ByParityIsNegativeWhereLinesOutCrossAnOddNumberOfTimes) {
  oracle::Mesh mesh;
  AddBox(-40 * 256, 30 * 256, mesh);
  AddBox(-20 * 256 + 77, 20 * 256, mesh);
  for (const Lattice& lattice : {Lattice::Named(NamedLattice::kCartesian).Scaled(0.7).value(), Triclinic()}) {
    const Band band{.width = 4, .in_voxels = true};
    const Vec3i shift{64, 0, -64};
    VoxelizeOptions options = With(band, true);
    options.interior_rule = InteriorRule::kParity;
    const Result result = Voxelize(ToWorld(mesh, lattice, shift), Unscaled(lattice), options);
    for (const auto& [ijk, value] : ValuesOf(result)) {
      const Vec3i at = ijk - shift;
      const auto is_in = [&](double low, double high) {
        return std::all_of(at.begin(), at.end(), [&](int32_t x) { return low < x && x < high; });
      };
      const bool is_on_inner = !is_in(-20 + 77.0 / 256, 20) && is_in(-20 + 76.0 / 256, 21);
      const bool inside = is_in(-40, 30) && !is_in(-20 + 77.0 / 256, 20) && !(is_on_inner && value == 0);
      ASSERT_EQ(value < 0, inside) << at[0] << ' ' << at[1] << ' ' << at[2] << ' ' << value;
      ASSERT_FALSE(value == 0 && std::signbit(value));
    }
    EXPECT_EQ(result.totals.tiles, 8U);
  }
}

// Moeller and Trumbore, in doubles, along a line that meets triangles only in their insides.
bool IsInside(const TriangleMesh& mesh, const Vec3d& point) {
  const Vec3d direction{0.5377, 0.7312, 0.4211};
  bool inside = false;
  for (const auto& triangle : mesh.triangles) {
    std::array<Vec3d, 3> v;
    for (size_t n = 0; n < 3; ++n) {
      for (size_t m = 0; m < 3; ++m) v[n][m] = mesh.vertices[triangle[n]][m];
    }
    const Vec3d e = v[1] - v[0], f = v[2] - v[0], p = Cross(direction, f), d = point - v[0], q = Cross(d, e);
    const double det = Dot(e, p), s = Dot(d, p) / det, t = Dot(direction, q) / det;
    inside ^= s > 0 && t > 0 && s + t < 1 && Dot(f, q) / det > 0;
  }
  return inside;
}

TEST(SignedBand, FollowsAConcaveSurfaceThroughManyTiles) {
  const TriangleMesh mesh = Sphere(16, 70);
  for (const NamedLattice name : {NamedLattice::kBcc, NamedLattice::kHexagonal}) {
    const Lattice lattice = Lattice::Named(name);
    const Values values = ValuesOf(Voxelize(mesh, Unscaled(lattice), With(Band{.width = 1.5}, true)));
    size_t n = 0, inside = 0;
    for (const auto& [ijk, value] : values) {
      if (n++ % 97 != 0 || std::abs(value) < 0.1F) continue;  // snapping moves the surface by less
      ASSERT_EQ(value < 0, IsInside(mesh, Apply(lattice.basis(), ijk))) << value;
      inside += value < 0;
    }
    EXPECT_GT(inside, 100U);
  }
}

TEST(SignedBand, HasTheDistancesOfTheUnsignedOne) {
  const TriangleMesh mesh = Sphere(10, 30);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kFcc));
  const Values plain = ValuesOf(Voxelize(mesh, grid, With(Band{.width = 3})));
  Values with_sign = ValuesOf(Voxelize(mesh, grid, With(Band{.width = 3}, true)));
  for (auto& [ijk, value] : with_sign) value = std::abs(value);
  EXPECT_EQ(with_sign, plain);
}

TEST(Band, IsTheSameForAnyThreadsAndOrderAndPartsAddUp) {
  TriangleMesh mesh = Sphere(20, 60);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kBcc));
  const Band band{.width = 2.5, .in_voxels = true};
  const Result whole = Voxelize(mesh, grid, With(band, true));
  const Values values = ValuesOf(whole);

  std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), std::mt19937(3));
  EXPECT_EQ(Voxelize(mesh, grid, With(band, true), 1).totals.fields, whole.totals.fields);

  Digest sum;
  Values joined;
  for (uint32_t index = 0; index < 3; ++index) {
    const Result part = Voxelize(
        mesh, grid, {.shard = Shard{index, 3}, .set = band, .fields = {Field::kDistance}, .signed_distance = true});
    sum.Add(part.totals.fields.at(0));
    joined.merge(ValuesOf(part));
  }
  EXPECT_EQ(sum, whole.totals.fields.at(0));
  EXPECT_EQ(joined, values);

  const IndexBox region{{-30, -5, 7}, {33, 70, 41}};
  Values in_region;
  std::copy_if(values.begin(), values.end(), std::inserter(in_region, in_region.end()),
               [&](const auto& value) { return region.Contains(value.first); });
  EXPECT_EQ(ValuesOf(Voxelize(mesh, grid,
                              {.region = region, .set = band, .fields = {Field::kDistance}, .signed_distance = true})),
            in_region);

  const size_t half = whole.tiles.size() / 2;
  const Result rest = Voxelize(
      mesh, grid,
      {.resume_after = whole.tiles[half].tile_ijk, .set = band, .fields = {Field::kDistance}, .signed_distance = true});
  EXPECT_EQ(rest.tiles.size(), whole.tiles.size() - half - 1);
  EXPECT_EQ(rest.tiles.front().fields, whole.tiles[half + 1].fields);
}

TEST(Band, DigestTellsOtherValuesAndNoOtherVoxelsApart) {
  const TriangleMesh mesh = Sphere(10, 20);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const JobTotals plain = Voxelize(mesh, grid, With(Band{.width = 2})).totals;
  const JobTotals with_sign = Voxelize(mesh, grid, With(Band{.width = 2}, true)).totals;
  EXPECT_EQ(plain.digest, with_sign.digest);
  EXPECT_NE(plain.fields, with_sign.fields);
}

TEST(Band, IsEstimatedFromTheAreaAndTheWidth) {
  const TriangleMesh mesh = Sphere(30, 60);
  for (const NamedLattice name : {NamedLattice::kCartesian, NamedLattice::kBcc}) {
    const Grid grid = Unscaled(Lattice::Named(name));
    for (const double width : {1.0, 3.0}) {
      const VoxelizeOptions options = With(Band{.width = width});
      const auto voxels = static_cast<double>(Voxelize(mesh, grid, options).totals.voxels);
      const double estimate = EstimateVoxels(mesh, ExtentOf(mesh), grid, *MakeRequest(options));
      EXPECT_NEAR(estimate, voxels, 0.1 * voxels);
      EXPECT_GT(EstimateVisits(mesh, ExtentOf(mesh), grid, *MakeRequest(options)), voxels);
    }
  }
}

TEST(Band, RefusesWhatItCannotBe) {
  const TriangleMesh closed = Sphere(6, 10);
  TriangleMesh open = closed;
  open.triangles.pop_back();
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const auto refusal = [&](const TriangleMesh& mesh, const Grid& on, const VoxelizeOptions& options) {
    const auto job = VoxelizeJob::Create(mesh, on, options);
    EXPECT_EQ(job.status().code(), absl::StatusCode::kInvalidArgument);
    return std::string(job.status().message());
  };
  EXPECT_THAT(refusal(open, grid, With(Band{.width = 1}, true)), HasSubstr("closed"));
  EXPECT_THAT(refusal(closed, grid, {.separability = 2, .set = Band{.width = 1}}),
              HasSubstr("separability 2: not together with band"));
  EXPECT_THAT(refusal(closed, grid, {.algorithm = Algorithm::kIncremental, .set = Band{.width = 1}}),
              HasSubstr("incremental"));
  for (const double width : {0.0, -1.0, std::nan("")}) {
    EXPECT_THAT(refusal(closed, grid, With(Band{.width = width})), HasSubstr("is not a finite number above 0"));
  }
  for (const double width : {1e300, 1e-300}) {
    EXPECT_THAT(refusal(closed, grid, With(Band{.width = width})), HasSubstr("band: a width of "));
  }
  EXPECT_THAT(refusal(closed, grid, With(Band{.width = 257})), HasSubstr("257 voxels on lattice axis i, the limit"));
  const Lattice skew = Lattice::FromBasis({{{1000, 0, 0}, {0, 1000, 0}, {2000, 0, 1}}}).value();
  EXPECT_THAT(refusal(closed, Unscaled(skew), With(Band{.width = 1})), HasSubstr("too skew"));
}

}  // namespace
}  // namespace latvox
