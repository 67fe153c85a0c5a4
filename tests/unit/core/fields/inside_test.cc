// One inside for signs, fractions and sides of links of every set, compared with lines of the exact oracle.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/voxelizer/voxelizer.h"
#include "tests/unit/core/exact.h"
#include "tests/unit/core/fields.h"
#include "tests/unit/core/fields/fraction_oracle.h"
#include "tests/unit/core/solid/line_fill.h"

namespace latvox {
namespace {

using testing::HasSubstr;

constexpr FieldList kFields{Field::kDistance, Field::kFraction};
constexpr uint32_t kPoints = 3;

const SetOption kSets[] = {SetOption{SeparatingSurface{}}, SetOption{SupercoverSurface{}},
                           SetOption{Band{1.5, true}},     SetOption{Links{LinkSide::kBoth}},
                           SetOption{Enclosed{}},          SetOption{Enclosed{.surface = SolidSurface::kNone}}};

// Tetrahedra that overlap, two of them oriented outwards.
oracle::Mesh OverlappingBodies(std::mt19937& random, int64_t grain) {
  std::uniform_int_distribution<int64_t> coordinate(0, 6 * 256 / grain);
  oracle::Mesh mesh;
  for (int body = 0; body < 3; ++body) {
    std::array<Int3, 4> v;
    for (Int3& p : v) p = {coordinate(random) * grain, coordinate(random) * grain, coordinate(random) * grain};
    AddTetrahedron(v, body == 2, mesh);
  }
  return mesh;
}

oracle::Mesh OneTurned(oracle::Mesh mesh) {
  std::swap(mesh[0][0], mesh[0][1]);
  return mesh;
}

// Returns the rule that a job chose.
InteriorRule RuleOf(const TriangleMesh& mesh, const Grid& grid, const VoxelizeOptions& options) {
  const auto job = VoxelizeJob::Create(mesh, grid, options);
  EXPECT_TRUE(job.ok()) << job.status();
  return job.ok() ? (*job)->facts().interior_rule : InteriorRule::kAuto;
}

class InsideOnLattice : public testing::TestWithParam<FormedLattice> {};

INSTANTIATE_TEST_SUITE_P(Exact, InsideOnLattice, testing::ValuesIn(FormedLattices()),
                         [](const auto& lattice) { return lattice.param.name; });

TEST_P(InsideOnLattice, IsThatOfTheRuleForSignsAndFractionsOfEverySet) {
  const Lattice& lattice = GetParam().lattice;
  const OwnerOracle owners(GetParam().form, kPoints);
  std::mt19937 random(36);
  size_t negative = 0, between = 0, number = 0;
  std::set<std::set<Int3>> insides;
  for (const int64_t grain : {256, 128, 1}) {
    const oracle::Mesh oriented = OverlappingBodies(random, grain);
    for (const auto& [asked, mesh] :
         {std::pair{InteriorRule::kParity, oriented}, std::pair{InteriorRule::kWinding, oriented},
          std::pair{InteriorRule::kPositive, oriented}, std::pair{InteriorRule::kAuto, oriented},
          std::pair{InteriorRule::kAuto, OneTurned(oriented)}}) {
      const bool is_oriented = mesh == oriented;
      const InteriorRule rule = RuleFor(asked, is_oriented);
      const std::set<Int3> inside = FillAlong(mesh, {0, 1, 0}, rule).inside;
      const std::map<Int3, int64_t> fractions = FractionsOf(mesh, owners, kPoints, rule);
      insides.insert(inside);
      const Vec3i shift = ++number % 2 == 0 ? Vec3i{62, -67, 63} : Vec3i{};
      const TriangleMesh world = ToWorld(mesh, lattice, shift);
      for (const SetOption& set : kSets) {
        SCOPED_TRACE(testing::Message() << grain << ' ' << NameOf(asked) << ' ' << set.index());
        const VoxelizeOptions options{
            .set = set, .fields = kFields, .signed_distance = true, .interior_rule = asked, .fraction_n = kPoints};
        ASSERT_EQ(RuleOf(world, Unscaled(lattice), options), rule);
        for (const auto& [ijk, of_voxel] : FieldsByVoxel(Voxelize(world, Unscaled(lattice), options).tiles, kFields)) {
          const Int3 z = ToOracle(ijk - shift);
          const float distance = NumbersOf<float>(of_voxel[0])[0];
          const int64_t fraction = NumbersOf<uint16_t>(of_voxel[1])[0];
          ASSERT_EQ(distance < 0, distance != 0 && inside.contains(z));
          ASSERT_EQ(fraction, fractions.contains(z) ? fractions.at(z) : 0);
          negative += distance < 0 ? 1 : 0;
          between += fraction > 0 && fraction < kPoints * kPoints * kPoints ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(negative, 300U);
  EXPECT_GT(between, 300U);
  EXPECT_GT(insides.size(), 6U) << "the rules differ";
}

TEST_P(InsideOnLattice, IsThatOfTheRuleForSidesOfLinks) {
  const Lattice& lattice = GetParam().lattice;
  std::mt19937 random(37);
  size_t ends = 0;
  for (const int64_t grain : {256, 128, 1}) {
    const oracle::Mesh mesh = OverlappingBodies(random, grain);
    const TriangleMesh world = ToWorld(mesh, lattice);
    for (const InteriorRule rule : {InteriorRule::kParity, InteriorRule::kWinding, InteriorRule::kPositive}) {
      const std::set<Int3> inside = FillAlong(mesh, {0, 1, 0}, rule).inside;
      const std::set<Int3> both = VoxelsOf(Voxelize(world, Unscaled(lattice), {.set = Links{}}));
      std::set<Int3> within, without;
      for (const Int3& z : both) (inside.contains(z) ? within : without).insert(z);
      for (const auto& [side, expected] :
           {std::pair{LinkSide::kInside, within}, std::pair{LinkSide::kOutside, without}}) {
        const VoxelizeOptions options{.set = Links{side}, .interior_rule = rule};
        EXPECT_EQ(VoxelsOf(Voxelize(world, Unscaled(lattice), options)), expected) << NameOf(rule);
        ends += expected.size();
      }
    }
  }
  EXPECT_GT(ends, 300U);
}

TEST(Inside, OfAMeshThatIsNotClosedByTheRuleIsRefused) {
  std::mt19937 random(38);
  const Grid grid = Unscaled(Lattice::Named(NamedLattice::kBcc));
  const oracle::Mesh oriented = OverlappingBodies(random, 1);
  oracle::Mesh open = oriented;
  open.pop_back();
  const auto refusal = [&](const oracle::Mesh& mesh, const VoxelizeOptions& options) {
    const auto job = VoxelizeJob::Create(ToWorld(mesh, grid.lattice), grid, options);
    EXPECT_EQ(job.status().code(), absl::StatusCode::kInvalidArgument);
    return std::string(job.status().message());
  };
  const FieldList distance{Field::kDistance};
  EXPECT_EQ(refusal(open, {.fields = distance, .signed_distance = true}),
            "mesh: it is not closed, which signed distances ask for");
  EXPECT_EQ(refusal(open, {.fields = {Field::kFraction}, .fraction_n = 2}),
            "mesh: it is not closed, which a fraction asks for");
  EXPECT_EQ(refusal(open, {.set = Links{LinkSide::kOutside}}),
            "mesh: it is not closed, which a side of links asks for");
  for (const InteriorRule rule : {InteriorRule::kWinding, InteriorRule::kPositive}) {
    EXPECT_THAT(refusal(OneTurned(oriented), {.set = Links{LinkSide::kInside}, .interior_rule = rule}),
                HasSubstr("not closed with one orientation, as the rule " + std::string(NameOf(rule)) + " asks"));
  }
}

}  // namespace
}  // namespace latvox
