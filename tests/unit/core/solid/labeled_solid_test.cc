// Labeled solids equal the exact oracle, which fills each label's triangles alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/voxelizer/estimate.h"
#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/fields.h"
#include "tests/unit/core/job_kinds.h"
#include "tests/unit/core/solid/labeled_bodies.h"
#include "tests/unit/core/solid/line_fill.h"

namespace latvox {
namespace {

constexpr InteriorRule kRules[] = {InteriorRule::kParity, InteriorRule::kWinding, InteriorRule::kPositive};
std::map<Int3, uint32_t> LabelsOf(const Result& result, const Vec3i& shift = {}) {
  std::map<Int3, uint32_t> labels;
  for (const auto& [ijk, fields] : FieldsByVoxel(result.tiles, {Field::kPart})) {
    labels[ToOracle(ijk - shift)] = NumbersOf<uint32_t>(fields[0])[0];
  }
  return labels;
}

Result Label(const TriangleMesh& mesh, const Lattice& lattice, Solid solid, int threads = 2) {
  solid.labels = Field::kPart;
  return Voxelize(mesh, Unscaled(lattice), {.set = solid, .fields = {Field::kPart}}, threads);
}

class LabeledSolidOnLattice : public testing::TestWithParam<ExactLattice> {};

INSTANTIATE_TEST_SUITE_P(Exact, LabeledSolidOnLattice, testing::ValuesIn(RestoredLattices()),
                         [](const auto& lattice) { return lattice.param.name; });

// Voxels of the surface alone have the label that they have in a solid without labels.
TEST_P(LabeledSolidOnLattice, EqualsTheOracleLabelByLabel) {
  const Lattice& lattice = GetParam().lattice;
  for (const Bodies& bodies : Adversaries()) {
    for (const Vec3i& shift : {Vec3i{0, 0, 0}, Vec3i{62, 60, 61}}) {
      const TriangleMesh world = bodies.World(lattice, shift);
      const auto near = LabelsOf(Voxelize(world, Unscaled(lattice), {.fields = {Field::kPart}}), shift);
      for (const InteriorRule rule : kRules) {
        for (const auto& priority : {std::vector<uint32_t>{}, kPriority}) {
          std::map<Int3, uint32_t> labels = Fill(bodies, rule, priority).labels;
          const Solid inside{.rule = rule, .surface = SolidSurface::kNone, .priority = priority};
          ASSERT_EQ(LabelsOf(Label(world, lattice, inside, shift[0] == 0 ? 1 : 2), shift), labels) << NameOf(rule);
          labels.insert(near.begin(), near.end());
          ASSERT_EQ(LabelsOf(Label(world, lattice, {.rule = rule, .priority = priority}), shift), labels);
        }
      }
    }
  }
}

TEST_P(LabeledSolidOnLattice, FillsEachLabelLineByLineIfForced) {
  const Lattice& lattice = GetParam().lattice;
  std::mt19937 random(23);
  for (Bodies bodies : Adversaries()) {
    const auto erased = static_cast<std::ptrdiff_t>(random() % bodies.mesh.size());
    bodies.mesh.erase(bodies.mesh.begin() + erased);
    bodies.labels.erase(bodies.labels.begin() + erased);
    for (const InteriorRule rule : kRules) {
      const Expected expected = Fill(bodies, rule, kPriority);
      for (const Vec3i& shift : {Vec3i{0, 0, 0}, Vec3i{62, 60, 61}}) {
        const TriangleMesh world = bodies.World(lattice, shift);
        const Solid solid{rule, SolidSurface::kNone, true, Field::kPart, kPriority};
        const auto job = VoxelizeJob::Create(world, Unscaled(lattice), {.set = solid, .fields = {Field::kPart}});
        ASSERT_TRUE(job.ok() && (*job)->Prepare().ok());
        EXPECT_EQ((*job)->facts().unbalanced_lines, expected.unbalanced);
        ASSERT_EQ(LabelsOf(Label(world, lattice, solid), shift), expected.labels) << NameOf(rule);
      }
    }
  }
}

// More labels in a tile than a word has bits.
TEST(LabeledSolids, MayHaveManyLabelsInATile) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  Bodies bodies;
  for (uint32_t n = 0; n < 150; ++n) {
    const Int3 low{(n * 37) % 11 * 64, (n * 53) % 13 * 64, (n * 29) % 17 * 64};
    bodies.Add(Box(low, {low[0] + 700, low[1] + 600, low[2] + 500}), n * 31 % 157);
  }
  const Solid solid{.surface = SolidSurface::kNone, .priority = {100, 3}};
  EXPECT_EQ(LabelsOf(Label(bodies.World(lattice, {}), lattice, solid)),
            Fill(bodies, InteriorRule::kWinding, solid.priority).labels);
}

// So many crossings in a tile that its labels are found one by one. Boxes lie between lattice points.
TEST(LabeledSolids, MayHaveManyCrossingsInATile) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  Bodies bodies;
  std::map<Int3, uint32_t> expected;
  for (uint32_t n = 0; n < 120; ++n) {
    const Int3 low{n * 37 % 11, n * 53 % 13, n * 29 % 17}, high{low[0] + 50, low[1] + 48 + n % 5, low[2] + 45 + n % 3};
    const auto at = [](const Int3& v) { return Int3{256 * v[0] - 128, 256 * v[1] - 128, 256 * v[2] - 128}; };
    bodies.Add(Box(at(low), at(high)), n);
    for (int64_t i = low[0]; i < high[0]; ++i) {
      for (int64_t j = low[1]; j < high[1]; ++j) {
        for (int64_t k = low[2]; k < high[2]; ++k) expected[{i, j, k}] = n;  // a larger number covers it
      }
    }
  }
  for (const InteriorRule rule : {InteriorRule::kParity, InteriorRule::kWinding}) {
    EXPECT_EQ(LabelsOf(Label(bodies.World(lattice, {}), lattice, {.rule = rule, .surface = SolidSurface::kNone})),
              expected);
  }
}

TEST(LabeledSolids, TakeTheSmallestNumberOfATrianglesCorners) {
  const Lattice lattice = Lattice::Named(NamedLattice::kBcc);
  Bodies bodies;
  bodies.Add(Box({0, 0, 0}, {768, 768, 768}), 4);
  TriangleMesh world = bodies.World(lattice, {});
  const Result plain = Label(world, lattice, {.surface = SolidSurface::kNone});
  for (size_t n = 0; n < world.attributes.size(); n += 3) world.attributes[n] = 9;
  EXPECT_EQ(LabelsOf(Label(world, lattice, {.surface = SolidSurface::kNone})), LabelsOf(plain));
}

absl::Status PrepareLabels(const Bodies& bodies, InteriorRule rule, InteriorRule* found = nullptr) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  const auto job = VoxelizeJob::Create(bodies.World(lattice, {}), Unscaled(lattice),
                                       {.set = Solid{.rule = rule, .labels = Field::kPart}, .fields = {Field::kPart}});
  if (!job.ok()) return job.status();
  const absl::Status status = (*job)->Prepare();
  if (found != nullptr) *found = (*job)->facts().interior_rule;
  return status;
}

TEST(LabeledSolids, OfLabelsThatAreNotClosedAreRefusedByName) {
  Bodies bodies;
  bodies.Add(Box({0, 0, 0}, {2560, 2560, 2560}), 8);
  oracle::Mesh open = Box({0, 0, 0}, {1280, 1280, 1280});
  open.erase(open.begin(), open.begin() + 2);
  bodies.Add(open, 5);
  EXPECT_EQ(PrepareLabels(bodies, InteriorRule::kAuto),
            absl::InvalidArgumentError("mesh: part 5 is not closed, and 25 of its lattice lines along k end "
                                       "unbalanced; force_open fills the others"));
  bodies.Add(open, 12);
  EXPECT_EQ(PrepareLabels(bodies, InteriorRule::kParity),
            absl::InvalidArgumentError("mesh: part 5 is not closed, and 25 of its lattice lines along k end "
                                       "unbalanced; 2 labels in all have no inside; force_open fills the others"));
  // Together they are closed, but neither is.
  Bodies halves;
  halves.Add(Box({0, 0, 0}, {256, 256, 256}), 1);
  for (size_t t = 0; t < 6; ++t) halves.labels[t] = 2;
  EXPECT_EQ(PrepareLabels(halves, InteriorRule::kParity).code(), absl::StatusCode::kInvalidArgument);
  Bodies turned;
  turned.Add(Box({0, 0, 0}, {2560, 2560, 2560}), 6);
  std::swap(turned.mesh[0][0], turned.mesh[0][1]);
  EXPECT_EQ(PrepareLabels(turned, InteriorRule::kWinding).message().substr(0, 69),
            "mesh: part 6 is not closed with one orientation, as the rule winding ");
}

TEST(LabeledSolids, AutoIsWindingIfEachLabelIsOrientedOtherwiseParityForAll) {
  Bodies bodies;
  bodies.Add(Box({0, 0, 0}, {2560, 2560, 2560}), 1);
  bodies.Add(Turned(Box({1280, 0, 0}, {3840, 2560, 2560})), 2);
  InteriorRule rule{};
  EXPECT_TRUE(PrepareLabels(bodies, InteriorRule::kAuto, &rule).ok());
  EXPECT_EQ(rule, InteriorRule::kWinding);
  std::swap(bodies.mesh[0][1], bodies.mesh[0][2]);
  EXPECT_TRUE(PrepareLabels(bodies, InteriorRule::kAuto, &rule).ok());
  EXPECT_EQ(rule, InteriorRule::kParity);
}

TEST(LabeledSolids, HaveALimitOfLabels) {
  Bodies bodies;
  for (uint32_t n = 0; n <= kMaxLabels; ++n) bodies.Add({{{{0, 0, 0}, {256, 0, 0}, {256, 0, 0}}}}, n);
  const absl::Status status = PrepareLabels(bodies, InteriorRule::kParity);
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(status.message(), "solid.labels part: the mesh has more than 65536 labels");
  bodies.mesh.pop_back();
  EXPECT_TRUE(PrepareLabels(bodies, InteriorRule::kParity).ok());
}

TriangleMesh Heap(uint32_t count, bool open) {
  TriangleMesh heap = HeapOfTetrahedra(count, 100, 30);
  if (open) heap.triangles.resize(heap.triangles.size() - 2);
  for (uint32_t n = 0; n < heap.vertices.size(); ++n) heap.attributes.push_back(n / 4 % 13);
  return heap;
}

// Other fields come from the nearest triangle, and do not change labels. Signs are those of the union.
TEST(LabeledSolids, MayHaveOtherFields) {
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kBcc));
  const TriangleMesh mesh = Heap(25, false);
  const Solid solid{.labels = Field::kPart};
  const FieldList fields = {Field::kDistance, Field::kPart};
  const Result alone = Voxelize(mesh, grid, {.set = solid, .fields = {Field::kPart}});
  const Result both = Voxelize(mesh, grid, {.set = solid, .fields = fields, .signed_distance = true});
  EXPECT_EQ(both.totals.fields[1], alone.totals.fields[0]);
  const auto inside = VoxelsOf(Voxelize(
      mesh, grid, {.set = Solid{.surface = SolidSurface::kNone, .labels = Field::kPart}, .fields = {Field::kPart}}));
  EXPECT_GT(inside.size(), 10000U);
  for (const auto& [ijk, values] : FieldsByVoxel(both.tiles, fields)) {
    const float distance = NumbersOf<float>(values[0])[0];
    ASSERT_TRUE(distance == 0 || (distance < 0) == inside.contains(ToOracle(ijk)));
  }
}

// Whatever the parts, the threads and the kernels.
TEST(LabeledSolids, AreTheUnionOfTheirParts) {
  for (const bool open : {false, true}) {
    const Grid grid = Unscaled(Lattice::Named(NamedLattice::kFcc));
    const TriangleMesh mesh = Heap(40, open);
    const VoxelizeOptions options{.region = IndexBox{{-40, -41, -70}, {70, 60, 90}},
                                  .set = Solid{InteriorRule::kAuto,
                                               open ? SolidSurface::kNone : SolidSurface::kSeparating,
                                               open,
                                               Field::kPart,
                                               {3, 1}},
                                  .fields = {Field::kPart}};
    const Result whole = Voxelize(mesh, grid, options, 1);
    EXPECT_GT(whole.totals.voxels, 20000U);
    for (const Simd simd : SimdHere()) {
      const ForcedSimd forced(simd);
      EXPECT_EQ(Voxelize(mesh, grid, options, 3).totals.fields, whole.totals.fields);
    }
    Digest shards;
    for (uint32_t index = 0; index < 3; ++index) {
      VoxelizeOptions shard = options;
      shard.shard = Shard{index, 3};
      shards.Add(Voxelize(mesh, grid, shard).totals.fields.at(0));
    }
    EXPECT_EQ(shards, whole.totals.fields[0]);
    JobTotals totals;
    for (size_t n = 0; n < 3; ++n) totals.Add(whole.tiles[n]);
    VoxelizeOptions resumed = options;
    resumed.resume_after = whole.tiles[2].tile_ijk;
    totals.Add(Voxelize(mesh, grid, resumed).totals);
    EXPECT_EQ(totals.fields, whole.totals.fields);
    VoxelizeOptions bounded = options, all = options;
    bounded.bounds = Bounds{{10, 10, 10}, {70, 60, 80}};
    all.region.reset();
    const auto everything = LabelsOf(Voxelize(mesh, grid, all));
    const auto some = LabelsOf(Voxelize(mesh, grid, bounded));
    EXPECT_GT(some.size(), 1000U);
    EXPECT_TRUE(std::ranges::all_of(some, [&](const auto& of) { return everything.at(of.first) == of.second; }));
  }
}

}  // namespace
}  // namespace latvox
