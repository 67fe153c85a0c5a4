// Fractions of labels, compared with all finer points one by one, and with labeled solids of the finer lattice.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "core/request/request.h"
#include "core/voxelizer/estimate.h"
#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/fields.h"
#include "tests/unit/core/fields/fraction_oracle.h"
#include "tests/unit/core/fields/shards.h"
#include "tests/unit/core/job_kinds.h"
#include "tests/unit/core/solid/labeled_bodies.h"
#include "tests/unit/core/sphere.h"

namespace latvox {
namespace {

constexpr InteriorRule kRules[] = {InteriorRule::kParity, InteriorRule::kWinding, InteriorRule::kPositive};
constexpr FieldList kFields{Field::kLabelFractions, Field::kPart, Field::kFraction};

using Fractions = std::map<Int3, std::vector<int64_t>>;  // of each label, by voxel

VoxelizeOptions Options(Solid solid, uint32_t n, std::vector<uint32_t> labels = {}) {
  solid.labels = Field::kPart;
  return {.set = solid, .fields = kFields, .fraction_n = n, .fraction_labels = std::move(labels)};
}

// Leaves out voxels without any. Checks that the fractions of all labels together are not less than their sum, and
// equal to it if `all` are there.
Fractions FractionsOf(const Result& result, size_t labels, bool all, const Vec3i& shift = {}) {
  Fractions fractions;
  for (const auto& [ijk, fields] : FieldsByVoxel(result.tiles, kFields, 0, labels)) {
    std::vector<int64_t> numbers;
    for (size_t n = 0; n < labels; ++n) {
      const auto first = fields[0].begin() + static_cast<std::ptrdiff_t>(n * sizeof(uint16_t));
      numbers.push_back(NumbersOf<uint16_t>({first, first + sizeof(uint16_t)})[0]);
    }
    const int64_t sum = std::accumulate(numbers.begin(), numbers.end(), int64_t{0});
    const int64_t together = NumbersOf<uint16_t>(fields[2])[0];
    EXPECT_TRUE(all ? sum == together : sum <= together) << sum << " of " << together;
    if (sum != 0) fractions[ToOracle(ijk - shift)] = numbers;
  }
  return fractions;
}

// Counts the points of each label one by one.
Fractions Count(const std::map<Int3, uint32_t>& labels_of_points, const OwnerOracle& owners,
                const std::vector<uint32_t>& labels) {
  Fractions fractions;
  for (const auto& [point, label] : labels_of_points) {
    const auto place = std::ranges::find(labels, label) - labels.begin();
    if (place == std::ssize(labels)) continue;
    std::vector<int64_t>& numbers = fractions[owners.OwnerOf(point)];
    numbers.resize(labels.size());
    ++numbers[static_cast<size_t>(place)];
  }
  return fractions;
}

Bodies Finer(Bodies bodies, int64_t n) {
  for (oracle::Triangle& triangle : bodies.mesh) {
    for (Int3& v : triangle) {
      for (int64_t& x : v) x *= n;
    }
  }
  return bodies;
}

std::vector<uint32_t> LabelsOf(const Bodies& bodies) {
  std::vector<uint32_t> labels;
  for (const auto& [label, mesh] : bodies.ByLabel()) labels.push_back(label);
  return labels;
}

class LabelFractionOnLattice : public testing::TestWithParam<FormedLattice> {};

INSTANTIATE_TEST_SUITE_P(Exact, LabelFractionOnLattice, testing::ValuesIn(FormedLattices()),
                         [](const auto& lattice) { return lattice.param.name; });

TEST_P(LabelFractionOnLattice, IsThatOfTheOracle) {
  const Lattice& lattice = GetParam().lattice;
  const std::vector<uint32_t> some = {40, 1000, 3, 2};  // no mesh has 1000
  size_t shared = 0, number = 0;
  for (const uint32_t n : {2U, 3U}) {
    const OwnerOracle owners(GetParam().form, n);
    for (const Bodies& bodies : Adversaries()) {
      const InteriorRule rule = kRules[number % 3];
      const std::vector<uint32_t> priority = number % 2 == 0 ? kPriority : std::vector<uint32_t>{};
      const Vec3i shift = number++ % 4 < 2 ? Vec3i{0, 0, 0} : Vec3i{62, -67, 61};
      const std::map<Int3, uint32_t> points = Fill(Finer(bodies, n), rule, priority).labels;
      const TriangleMesh world = bodies.World(lattice, shift);
      for (const std::vector<uint32_t>& asked : {std::vector<uint32_t>{}, some}) {
        SCOPED_TRACE(testing::Message() << n << ' ' << number << ' ' << asked.size());
        const std::vector<uint32_t> labels = asked.empty() ? LabelsOf(bodies) : asked;
        const Solid solid{.rule = rule, .surface = SolidSurface::kSupercover, .priority = priority};
        const Result result = Voxelize(world, Unscaled(lattice), Options(solid, n, asked));
        const Fractions expected = Count(points, owners, labels);
        ASSERT_EQ(FractionsOf(result, labels.size(), asked.empty(), shift), expected);
        for (const auto& [z, numbers] : expected) {
          shared += std::ranges::count_if(numbers, [](int64_t count) { return count != 0; }) > 1 ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(shared, 300U);
}

// Spheres that overlap, over several tiles, with triangles from tiny to as large as a cell.
Bodies Spheres(int rings, float radius) {
  Bodies bodies;
  const TriangleMesh sphere = Sphere(rings, radius);
  for (const auto& [label, center] : std::map<uint32_t, Int3>{{5, {0, 0, 0}}, {2, {10, 3, 5}}, {9, {-4, 12, 7}}}) {
    oracle::Mesh mesh;
    for (const auto& indices : sphere.triangles) {
      oracle::Triangle triangle;
      for (size_t c = 0; c < 3; ++c) {
        for (size_t m = 0; m < 3; ++m) {
          triangle[c][m] = std::llround(sphere.vertices[indices[c]][m] * 256) + center[m] * 256;
        }
      }
      mesh.push_back(triangle);
    }
    bodies.Add(mesh, label);
  }
  return bodies;
}

TEST_P(LabelFractionOnLattice, IsThatOfALabeledSolidOnTheFinerLattice) {
  const Lattice& lattice = GetParam().lattice;
  const Bodies bodies = Spheres(30, 9);
  constexpr uint32_t kN = 3;
  for (const std::vector<uint32_t>& priority : {std::vector<uint32_t>{}, std::vector<uint32_t>{2, 5, 9}}) {
    const Solid inside{.surface = SolidSurface::kNone, .labels = Field::kPart, .priority = priority};
    const Result finer =
        Voxelize(Finer(bodies, kN).World(lattice, {}), Unscaled(lattice), {.set = inside, .fields = {Field::kPart}});
    std::map<Int3, uint32_t> points;
    for (const auto& [ijk, fields] : FieldsByVoxel(finer.tiles, {Field::kPart})) {
      points[ToOracle(ijk)] = NumbersOf<uint32_t>(fields[0])[0];
    }
    const Solid solid{.surface = SolidSurface::kSupercover, .priority = priority};
    const Result result = Voxelize(bodies.World(lattice, {}), Unscaled(lattice), Options(solid, kN));
    EXPECT_EQ(FractionsOf(result, 3, true), Count(points, OwnerOracle(GetParam().form, kN), {2, 5, 9}));
  }
}

TEST(LabelFraction, OfPartsIsThatOfTheWhole) {
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kBcc));
  const TriangleMesh mesh = Spheres(40, 36).World(grid.lattice, {});
  const VoxelizeOptions whole = Options({}, 3);
  const Result all = Voxelize(mesh, grid, whole);
  ExpectPartsAddUp(mesh, grid, whole, all);
  VoxelizeOptions some = whole;
  some.region = IndexBox{{-7, -70, 5}, {40, 3, 69}};
  const Fractions fractions = FractionsOf(all, 3, true), found = FractionsOf(Voxelize(mesh, grid, some), 3, true);
  EXPECT_GT(found.size(), 5000U);
  for (const auto& [z, numbers] : found) ASSERT_EQ(fractions.at(z), numbers);
}

TEST(LabelFraction, DoesNotDependOnKernelsThreadsOrTheOrderOfTriangles) {
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kFcc));
  TriangleMesh mesh = Spheres(30, 12).World(grid.lattice, {});
  const VoxelizeOptions options = Options({}, 8);
  const JobTotals expected = Voxelize(mesh, grid, options).totals;
  std::ranges::reverse(mesh.triangles);
  WithEachSimd([&] {
    for (const int threads : {1, 2}) EXPECT_EQ(Voxelize(mesh, grid, options, threads).totals.fields, expected.fields);
  });
}

// Most cells have points of many labels.
TEST(LabelFraction, OfAHeapIsThatOfItsFinerHeap) {
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  TriangleMesh heap = HeapOfTetrahedra(1500);
  for (size_t n = 0; n < heap.vertices.size(); ++n) {
    heap.attributes.push_back(static_cast<uint32_t>(n / 4 % 7));
    for (float& x : heap.vertices[n]) x = std::round(x * 256) / 256;
  }
  constexpr uint32_t kN = 3;
  TriangleMesh finer = heap;
  for (Vec3f& v : finer.vertices) v = v * float{kN};
  const Solid inside{.surface = SolidSurface::kNone, .labels = Field::kPart};
  std::map<Int3, uint32_t> points;
  for (const auto& [ijk, fields] :
       FieldsByVoxel(Voxelize(finer, grid, {.set = inside, .fields = {Field::kPart}}).tiles, {Field::kPart})) {
    points[ToOracle(ijk)] = NumbersOf<uint32_t>(fields[0])[0];
  }
  const OwnerOracle owners({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}, kN);
  const Result result = Voxelize(heap, grid, Options({.surface = SolidSurface::kSupercover}, kN));
  EXPECT_EQ(FractionsOf(result, 7, true), Count(points, owners, {0, 1, 2, 3, 4, 5, 6}));
}

TEST(LabelFraction, IsEstimatedByTheNumberOfLabels) {
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  const TriangleMesh mesh = Spheres(30, 12).World(grid.lattice, {});
  const auto visits = [&](const VoxelizeOptions& options) {
    return EstimateVisits(mesh, ExtentOf(mesh), grid, *MakeRequest(options));
  };
  VoxelizeOptions plain = Options({}, 8);
  plain.fields = {Field::kPart, Field::kFraction};
  const double one = visits(Options({}, 8, {2})), two = visits(Options({}, 8, {2, 5}));
  EXPECT_LT(visits(plain), one);
  EXPECT_LT(one, two);
  EXPECT_NEAR(visits(Options({}, 8)), one + 31 * (two - one), one * 1e-9) << "as many as there may be";
}

absl::Status RefusalOf(const VoxelizeOptions& options, uint32_t labels = 1) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  Bodies bodies;
  for (uint32_t n = 0; n < labels; ++n) bodies.Add(Box({0, 0, 512 * n}, {256, 256, 512 * n + 256}), n);
  return VoxelizeJob::Create(bodies.World(lattice, {}), Unscaled(lattice), options).status();
}

TEST(LabelFraction, HasALimitOfLabels) {
  EXPECT_TRUE(RefusalOf(Options({}, 2), 32).ok());
  const absl::Status refusal = RefusalOf(Options({}, 2), 33);
  EXPECT_EQ(refusal.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(refusal.message(),
            "fraction_labels: the mesh has 33 labels, the limit is 32; the request may list some of them");
  EXPECT_TRUE(RefusalOf(Options({}, 2, {3, 32, 500}), 33).ok());
  std::vector<uint32_t> many(33);
  std::iota(many.begin(), many.end(), 0);
  EXPECT_EQ(RefusalOf(Options({}, 2, many)).message(), "fraction_labels: 33 labels exceed 32");
}

TEST(LabelFraction, HasAllLabelsOfTheMeshUnlessTheRequestListsSome) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  for (const std::vector<uint32_t>& asked : {std::vector<uint32_t>{}, {40, 1000, 3}}) {
    VoxelizeOptions options = Options({.priority = kPriority}, 2, asked);
    options.region = IndexBox{{-9, -9, -9}, {-8, -8, -8}};  // whatever the part
    const auto job = VoxelizeJob::Create(Adversaries()[0].World(lattice, {}), Unscaled(lattice), options);
    EXPECT_EQ((*job)->facts().fraction_labels, asked.empty() ? std::vector<uint32_t>({3, 5, 7, 40}) : asked);
  }
}

TEST(LabelFraction, NeedsLabels) {
  VoxelizeOptions options = Options({}, 2, {1, 1});
  EXPECT_EQ(RefusalOf(options).message(), "fraction_labels 1 occurs twice");
  options.fraction_labels = {1, 0x80000000};
  EXPECT_EQ(RefusalOf(options).message(), "fraction_labels 2147483648 exceeds 2147483647");
  options.fraction_labels = {1};
  options.set = Solid{};
  EXPECT_EQ(RefusalOf(options).message(), "fields label_fractions: needs a solid with solid.labels");
  options.set = Enclosed{.labels = Field::kPart};
  EXPECT_EQ(RefusalOf(options).message(),
            "fields label_fractions: not together with enclosed, whose triangles need not be closed");
  options.set = Band{1, true};
  EXPECT_EQ(RefusalOf(options).message(), "fields label_fractions: needs a solid with solid.labels");
  options.fields = {Field::kFraction};
  EXPECT_EQ(RefusalOf(options).message(), "fraction_labels: needs label_fractions among fields");
  EXPECT_EQ(RefusalOf(Options({}, 1)).message(), "fraction_n 1 is below 2");
  EXPECT_EQ(RefusalOf(Options({.force_open = true}, 2)).message(),
            "fields label_fractions: not together with solid.force_open true, which fills a mesh that is not closed");
}

}  // namespace
}  // namespace latvox
