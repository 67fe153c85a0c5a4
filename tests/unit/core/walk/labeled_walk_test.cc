// Enclosed sets of labels equal a flood fill for each label alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/voxelizer/voxelizer.h"
#include "core/voxelizer/walk_estimate.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/fields.h"
#include "tests/unit/core/fields/shards.h"
#include "tests/unit/core/solid/labeled_bodies.h"
#include "tests/unit/core/sphere.h"
#include "tests/unit/core/walk/flood.h"
#include "tests/unit/dose.h"

namespace latvox {
namespace {

using LabelsByPoint = std::map<Int3, uint32_t>;

LabelsByPoint LabelsOf(const Result& result, const Vec3i& shift = {}) {
  LabelsByPoint labels;
  for (const auto& [ijk, fields] : FieldsByVoxel(result.tiles, {Field::kPart})) {
    labels[ToOracle(ijk - shift)] = NumbersOf<uint32_t>(fields[0])[0];
  }
  return labels;
}

// The bodies without a triangle of each label, and with triangles that no label encloses anything by.
std::vector<Bodies> OpenAdversaries() {
  std::vector<Bodies> all = Adversaries();
  const size_t closed = all.size();
  for (size_t n = 0; n < closed; ++n) {
    Bodies open;
    std::set<uint32_t> opened;
    for (size_t t = 0; t < all[n].mesh.size(); ++t) {
      if (all[n].labels[t] % 2 != 0 && opened.insert(all[n].labels[t]).second) continue;
      open.Add({all[n].mesh[t]}, all[n].labels[t]);
    }
    open.Add({{Int3{-100, 50, 700}, Int3{2000, 900, 800}, Int3{300, 2100, 850}}}, 8);
    all.push_back(open);
  }
  return all;
}

// Labels from the lowest priority up.
std::vector<uint32_t> OrderOf(const std::map<uint32_t, oracle::Mesh>& parts, const std::vector<uint32_t>& priority) {
  std::vector<uint32_t> order;
  for (const auto& [label, mesh] : parts) {
    if (!std::ranges::count(priority, label)) order.push_back(label);
  }
  for (auto label = priority.rbegin(); label != priority.rend(); ++label) {
    if (parts.contains(*label)) order.push_back(*label);
  }
  return order;
}

struct Case {
  ExactLattice lattice;
  int64_t k;
};

std::vector<Case> Cases() {
  std::vector<Case> cases;
  for (const ExactLattice& lattice : RestoredLattices()) {
    for (const int64_t k : {0, 1, 2}) cases.push_back({lattice, k});
  }
  return cases;
}

class LabeledWalkOnLattice : public testing::TestWithParam<Case> {
 protected:
  // The points that each label encloses, by a flood of its triangles alone.
  void ExpectFloods(const Bodies& bodies, double close, const Vec3i& shift, const std::vector<uint32_t>& priority,
                    bool minimal) {
    const Lattice& lattice = GetParam().lattice.lattice;
    const int64_t k = GetParam().k;
    const Flood flood({{-13, -13, -13}, {19, 19, 19}}, Directions(lattice.frames(static_cast<int>(k))));
    const auto parts = bodies.ByLabel();
    LabelsByPoint enclosed, interior;
    std::map<uint32_t, std::vector<uint64_t>> cavities;
    for (const uint32_t label : OrderOf(parts, priority)) {
      const TriangleMesh alone = ToWorld(parts.at(label), lattice, shift);
      const Points surface =
          VoxelsOf(Voxelize(alone, Unscaled(lattice), {.separability = k, .minimal = minimal}), shift);
      const Flood::Marks walls = flood.MarksOf(surface);
      Flood::Marks thick = walls;
      if (close > 0) {
        for (const Int3& z : VoxelsOf(Voxelize(alone, Unscaled(lattice), {.set = Band{close / 2, false}}), shift)) {
          thick[flood.NumberOf(z)] = 1;
        }
      }
      const Flood::Marks reached = flood.FromOutside(thick);
      const Flood::Marks outside = close > 0 ? flood.Grown(walls, reached, lattice.basis(), close / 2) : reached;
      cavities[label] = flood.Cavities(thick, reached);
      for (const Int3& z : flood.Unmarked(outside)) {
        enclosed[z] = label;
        if (!surface.contains(z)) interior[z] = label;
      }
    }
    const TriangleMesh world = bodies.World(lattice, shift);
    for (const SolidSurface with : {SolidSurface::kSeparating, SolidSurface::kNone}) {
      const Enclosed set{.surface = with, .close = close, .labels = Field::kPart, .priority = priority};
      const VoxelizeOptions options{.separability = k, .minimal = minimal, .set = set, .fields = {Field::kPart}};
      const Result result = Voxelize(world, Unscaled(lattice), options, minimal ? 1 : 2);
      ASSERT_EQ(LabelsOf(result, shift), with == SolidSurface::kNone ? interior : enclosed);
      found_ += interior.size();
      ExpectFacts(world, options, cavities);
    }
  }

  static void ExpectFacts(const TriangleMesh& world, const VoxelizeOptions& options,
                          const std::map<uint32_t, std::vector<uint64_t>>& cavities) {
    auto job = VoxelizeJob::Create(world, Unscaled(GetParam().lattice.lattice), options);
    ASSERT_TRUE(job.ok() && (*job)->Prepare().ok());
    const WalkFacts& facts = *(*job)->facts().walk;
    ASSERT_EQ(facts.labels.size(), cavities.size());
    uint64_t sum = 0;
    auto of_label = facts.labels.begin();
    for (const auto& [label, sizes] : cavities) {
      EXPECT_EQ(of_label->label, label);
      EXPECT_EQ(of_label->cavities, sizes.size());
      uint64_t points = 0;
      for (const uint64_t size : sizes) points += size;
      EXPECT_EQ(of_label->points, points);
      sum += sizes.size();
      ++of_label;
    }
    EXPECT_EQ(facts.cavities, sum);
  }

  size_t found_ = 0;  // points off the surface
};

INSTANTIATE_TEST_SUITE_P(Exact, LabeledWalkOnLattice, testing::ValuesIn(Cases()),
                         [](const auto& test) { return test.param.lattice.name + "_" + std::to_string(test.param.k); });

// In one tile, over the corner of eight tiles, and at negative coordinates.
constexpr Vec3i kShifts[] = {{8, 8, 8}, {60, 59, 61}, {-68, 1022, -1}};

TEST_P(LabeledWalkOnLattice, EqualsAFloodOfEachLabel) {
  const std::vector<Bodies> all = OpenAdversaries();
  for (size_t number = 0; number < all.size(); number += Dose(1, 5)) {
    SCOPED_TRACE(number);
    const auto priority = number % 2 == 0 ? std::vector<uint32_t>{} : kPriority;
    ExpectFloods(all[number], 0, kShifts[number % 3], priority, number % 4 < 2);
    if (HasFailure()) return;
  }
  EXPECT_GT(found_, Dose(400U, 40U));
}

TEST_P(LabeledWalkOnLattice, ClosesHolesOfEachLabel) {
  const std::vector<Bodies> all = OpenAdversaries();
  const double size = GetParam().lattice.lattice.voxel_size();
  for (const size_t number : {all.size() / 2, all.size() / 2 + 1}) {
    SCOPED_TRACE(number);
    for (const double close : {1.237 * size, 4.119 * size})
      ExpectFloods(all[number], close, kShifts[1], kPriority, true);
  }
  EXPECT_GT(found_, 100U);
}

// Spheres with openings, so fine that most triangles are tiny, and others.
TriangleMesh Spheres(const Vec3f& step = {25, 0, 0}) {
  TriangleMesh all;
  const float radius[] = {24, 20, 28};
  for (uint32_t n = 0; n < 3; ++n) {
    TriangleMesh one = Sphere(n == 1 ? 12 : 90, radius[n]);
    if (n != 2) one.triangles.erase(one.triangles.end() - (n == 1 ? 3 : 41));
    const auto first = static_cast<uint32_t>(all.vertices.size());
    for (const Vec3f& v : one.vertices) {
      all.vertices.push_back(v + Vec3f{0, 60, 61} + step * static_cast<float>(n));
      all.attributes.push_back(n);
    }
    for (const auto& [a, b, c] : one.triangles) all.triangles.push_back({first + a, first + b, first + c});
  }
  return all;
}

VoxelizeOptions LabelsOfSpheres() {
  return {.separability = 2, .set = Enclosed{.labels = Field::kPart, .priority = {1}}, .fields = {Field::kPart}};
}

// Each label alone, and its voxels in the whole.
void ExpectEachLabelAlone(const TriangleMesh& mesh) {
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kFcc));
  LabelsByPoint expected;
  for (const uint32_t label : {0, 2, 1}) {
    TriangleMesh alone = mesh;
    std::erase_if(alone.triangles, [&](const auto& corners) { return mesh.attributes[corners[0]] != label; });
    alone.attributes.clear();
    for (const Int3& z : VoxelsOf(Voxelize(alone, grid, {.separability = 2, .set = Enclosed{}}))) expected[z] = label;
  }
  EXPECT_GT(expected.size(), 50000U);
  EXPECT_EQ(LabelsOf(Voxelize(mesh, grid, LabelsOfSpheres())), expected);
}

TEST(LabeledWalk, OfFineMeshesIsThatOfEachLabelAlone) { ExpectEachLabelAlone(Spheres()); }

// So far from each other that the tiles between them are looked at in cubes.
TEST(LabeledWalk, OfFarMeshesIsThatOfEachLabelAlone) { ExpectEachLabelAlone(Spheres({1500, 20, -700})); }

TEST(LabeledWalk, PartsAreThoseOfTheWhole) {
  const TriangleMesh mesh = Spheres();
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  for (const double close : Dose<std::vector<double>>({0.0, 3.3}, {3.3})) {
    VoxelizeOptions options = LabelsOfSpheres();
    std::get<Enclosed>(options.set).close = close;
    const Result whole = Voxelize(mesh, grid, options);
    ExpectPartsAddUp(mesh, grid, options, whole);
    const LabelsByPoint all = LabelsOf(whole);
    options.region = IndexBox{{-20, 30, 41}, {47, 70, 90}};
    LabelsByPoint expected;
    for (const auto& [z, label] : all) {
      if (options.region->Contains({int32_t(z[0]), int32_t(z[1]), int32_t(z[2])})) expected[z] = label;
    }
    EXPECT_GT(expected.size(), 10000U);
    EXPECT_EQ(LabelsOf(Voxelize(mesh, grid, options, 1)), expected);
  }
}

// Other fields come from the nearest triangle of the whole mesh, and do not change labels.
TEST(LabeledWalk, MayHaveOtherFields) {
  const TriangleMesh mesh = Spheres();
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kCartesian));
  VoxelizeOptions options = LabelsOfSpheres();
  const Result alone = Voxelize(mesh, grid, options);
  options.fields = {Field::kTriangle, Field::kPart};
  const Result both = Voxelize(mesh, grid, options);
  EXPECT_EQ(both.totals.fields[1], alone.totals.fields[0]);
  size_t others = 0;
  for (const auto& [ijk, fields] : FieldsByVoxel(both.tiles, options.fields)) {
    const uint32_t triangle = NumbersOf<uint32_t>(fields[0])[0];
    others += mesh.attributes[mesh.triangles[triangle][0]] != NumbersOf<uint32_t>(fields[1])[0] ? 1 : 0;
  }
  EXPECT_GT(others, 100U);
}

TEST(LabeledWalk, ExplainsTheLeaksOfLabelsAroundAPoint) {
  Bodies bodies;
  oracle::Mesh open = Box({100, 100, 100}, {3100, 3100, 3100});
  open.erase(open.begin());
  bodies.Add(open, 4);
  bodies.Add(Box({700, 700, 700}, {2500, 2500, 2500}), 3);
  bodies.Add(Box({9000, 100, 100}, {10000, 3100, 3100}), 9);
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  const Enclosed set{.leak_from = Vec3d{6, 6, 6}, .labels = Field::kPart};
  auto job = VoxelizeJob::Create(bodies.World(lattice, {}), Unscaled(lattice), {.set = set, .fields = {Field::kPart}});
  ASSERT_TRUE(job.ok() && (*job)->Prepare().ok());
  const WalkFacts& facts = *(*job)->facts().walk;
  EXPECT_FALSE(facts.leak);
  ASSERT_EQ(facts.labels.size(), 3U);
  ASSERT_TRUE(facts.labels[0].leak && facts.labels[1].leak);
  EXPECT_EQ(facts.labels[0].label, 3U);
  EXPECT_EQ(facts.labels[0].leak->kind, Leak::kNone);
  EXPECT_EQ(facts.labels[1].label, 4U);
  EXPECT_EQ(facts.labels[1].leak->kind, Leak::kFound);
  EXPECT_EQ(facts.labels[1].leak->path.front(), (Vec3i{6, 6, 6}));
  EXPECT_EQ(facts.labels[1].cavities, 0U);
  EXPECT_FALSE(facts.labels[2].leak);
}

// Ten closed boxes, and open ones of lower priorities.
TEST(LabeledWalk, ExplainsAtMostEightLeaksWhateverIsClosed) {
  const oracle::Mesh closed = Box({100, 100, 100}, {3100, 3100, 3100});
  oracle::Mesh open = closed;
  open.erase(open.begin());
  Bodies bodies;
  for (uint32_t n = 0; n < 10; ++n) {
    bodies.Add(open, n);
    bodies.Add(closed, 10 + n);
  }
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  const Enclosed set{.leak_from = Vec3d{6, 6, 6}, .labels = Field::kPart};
  auto job = VoxelizeJob::Create(bodies.World(lattice, {}), Unscaled(lattice), {.set = set, .fields = {Field::kPart}});
  ASSERT_TRUE(job.ok() && (*job)->Prepare().ok());
  const WalkFacts& facts = *(*job)->facts().walk;
  ASSERT_EQ(facts.labels.size(), 20U);
  for (const LabelWalkFacts& label : facts.labels) {
    SCOPED_TRACE(label.label);
    ASSERT_EQ(label.leak.has_value(), label.label >= 2);
    if (label.leak) {
      EXPECT_EQ(label.leak->kind, label.label < 10 ? Leak::kFound : Leak::kNone);
    }
  }
}

TEST(LabeledWalk, HasALimitOfLabels) {
  Bodies bodies;
  for (uint32_t n = 0; n <= kMaxWalkLabels; ++n) bodies.Add({{{{0, 0, 0}, {256, 0, 0}, {256, 0, 0}}}}, n);
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  const VoxelizeOptions options{.set = Enclosed{.labels = Field::kPart}, .fields = {Field::kPart}};
  const absl::Status status = VoxelizeJob::Create(bodies.World(lattice, {}), Unscaled(lattice), options).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(status.message(), "enclosed.labels part: the mesh has more than 4096 labels");
  const absl::StatusOr<VoxelRequest> request = MakeRequest(options);
  ASSERT_TRUE(request.ok()) << request.status();
  EXPECT_EQ(MostWalks(bodies.World(lattice, {}), *request), double{kMaxWalkLabels});
}

}  // namespace
}  // namespace latvox
