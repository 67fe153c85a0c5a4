#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <random>
#include <set>

#include "client/internal/vec3.h"
#include "client/tool/cli/slice_command.h"
#include "client/tool/cli/value_difference.h"
#include "client/tool/cli/voxel_difference.h"
#include "latvox/for_each_voxel.h"
#include "tests/unit/client/fields.h"

namespace latvox::client {
namespace {

using testing::IsEmpty;

std::vector<Brick> ToBricks(const std::set<Vec3i>& voxels) {
  std::map<Vec3i, Brick> bricks;
  for (const Vec3i& ijk : voxels) {
    Brick& brick = bricks[{ijk[0] >> 3, ijk[1] >> 3, ijk[2] >> 3}];
    brick.brick_ijk = {ijk[0] >> 3, ijk[1] >> 3, ijk[2] >> 3};
    brick.mask[static_cast<size_t>(ijk[0] & 7)] |= uint64_t{1} << ((ijk[1] & 7) << 3 | (ijk[2] & 7));
  }
  std::vector<Brick> out;
  for (const auto& [unused, brick] : bricks) out.push_back(brick);
  return out;
}

TEST(CompareVoxels, CountsWhatSetsOfPointsSay) {
  std::mt19937 chance(5);
  for (int round = 0; round < 50; ++round) {
    std::set<Vec3i> a, b, only_a, only_b;
    const auto fill = [&](std::set<Vec3i>& set) {
      for (int n = 0; n < 40 * (round % 3); ++n) {
        const auto coordinate = [&] { return static_cast<int32_t>(chance() % 24) - 10; };
        set.insert({coordinate(), coordinate() / 8, coordinate() / 4});
      }
    };
    fill(a);
    fill(b);
    if (round % 5 == 0) b = a;
    std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::inserter(only_a, only_a.end()));
    std::set_difference(b.begin(), b.end(), a.begin(), a.end(), std::inserter(only_b, only_b.end()));
    const VoxelDifference found = CompareVoxels(ToBricks(a), ToBricks(b));
    EXPECT_EQ(found.only_a, only_a.size());
    EXPECT_EQ(found.only_b, only_b.size());
    EXPECT_EQ(found.both, a.size() - only_a.size());
    EXPECT_EQ(found.equal(), a == b);
    const size_t all = found.both + only_a.size() + only_b.size();
    EXPECT_DOUBLE_EQ(found.Jaccard(), all == 0 ? 1 : double(found.both) / double(all));
    EXPECT_EQ(found.first.size(), std::min(only_a.size() + only_b.size(), VoxelDifference::kFirst));
    for (const auto& [ijk, in_a] : found.first) EXPECT_TRUE((in_a ? only_a : only_b).contains(ijk));
    EXPECT_EQ(found.box.has_value(), a != b);
    if (!found.box) continue;
    only_a.merge(only_b);
    for (size_t m = 0; m < 3; ++m) {
      const auto [least, most] = std::minmax_element(only_a.begin(), only_a.end(),
                                                     [m](const Vec3i& p, const Vec3i& q) { return p[m] < q[m]; });
      EXPECT_EQ(found.box->min[m], (*least)[m]);
      EXPECT_EQ(found.box->max[m], (*most)[m] + 1);
    }
  }
}

// Voxels at different indices in their files.
TEST(CompareValues, HoldsTheSameVoxelsAgainstEachOther) {
  const std::set<Vec3i> voxels_a = {{0, 0, 0}, {0, 0, 1}, {9, 0, 0}, {20, 3, 3}},
                        voxels_b = {{-9, 0, 0}, {0, 0, 1}, {9, 0, 0}, {9, 1, 0}, {20, 3, 3}};
  GridContent a{{{}, ToBricks(voxels_a)}}, b{{{}, ToBricks(voxels_b)}};
  EXPECT_FALSE(CompareValues(a, b).distances.has_value());
  EXPECT_TRUE(CompareValues(a, b).equal());
  a.fields = {ValuesOf<float>(Field::kDistance, {0, 0.5F, 0.25F, -1})};
  b.fields = {ValuesOf<float>(Field::kDistance, {7, 0.5F, 0.25F, 7, -1})};
  EXPECT_EQ(CompareValues(a, b).distances->differ, 0u);
  EXPECT_TRUE(CompareValues(a, b).equal());
  b.fields = {ValuesOf<float>(Field::kDistance, {7, 0.75F, 0.25F, 7, 1})};
  const auto distances = *CompareValues(a, b).distances;
  EXPECT_EQ(distances.differ, 2u);
  EXPECT_EQ(distances.greatest, 2);
  EXPECT_EQ(distances.at, (Vec3i{20, 3, 3}));
  EXPECT_FALSE(CompareValues(a, b).equal());
  a.fields = {ValuesOf<uint32_t>(Field::kPart, {0, 1, 2, 3}),
              ValuesOf<uint8_t>(Field::kColor, {0, 0, 10, 0, 0, 11, 0, 0, 12, 0, 0, 13})};
  b.fields = {ValuesOf<uint8_t>(Field::kColor, {0, 0, 7, 0, 0, 11, 0, 0, 12, 0, 0, 7, 0, 0, 14})};
  const auto others = CompareValues(a, b).others;
  ASSERT_EQ(others.size(), 1u);
  EXPECT_EQ(others[0], std::make_pair(Field::kColor, uint64_t{1}));
}

TEST(CompareValues, CountsLinksThatAreCrossedInOneFileAlone) {
  const std::set<Vec3i> voxels_a = {{0, 0, 0}, {0, 0, 1}, {9, 0, 0}}, voxels_b = {{0, 0, 1}, {9, 0, 0}, {9, 0, 1}};
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  GridContent a{{{}, ToBricks(voxels_a)}}, b{{{}, ToBricks(voxels_b)}};
  a.neighbors = b.neighbors = {{0, 0, -1}, {0, 0, 1}};
  a.fields = {ValuesOf<float>(Field::kLinks, {1, 1, 0.25F, kNone, 0.5F, kNone}),
              ValuesOf<uint32_t>(Field::kLinkCrossings, {7, 7, 1, 0, 2, 0})};
  b.fields = {ValuesOf<float>(Field::kLinks, {0.25F, 0.5F, 0.75F, kNone, kNone, kNone}),
              ValuesOf<uint32_t>(Field::kLinkCrossings, {1, 1, 2, 0, 7, 7})};
  for (GridContent* const each : {&a, &b}) {
    for (FieldValues& values : each->fields) values.neighbors = 2;
  }
  const ValueDifference found = CompareValues(a, b);
  ASSERT_TRUE(found.links.has_value());
  EXPECT_EQ(found.links->crossed_in_one, 1u);
  EXPECT_EQ(found.links->greatest, 0.25);
  const std::vector<std::pair<Field, uint64_t>> others = {{Field::kLinks, 2}, {Field::kLinkCrossings, 1}};
  EXPECT_EQ(found.others, others);
  b.neighbors = {{-1, 0, 0}, {1, 0, 0}};
  EXPECT_TRUE(CompareValues(a, b).others.empty());
  EXPECT_FALSE(CompareValues(a, b).links.has_value());
}

TEST(CompareFields, TellsWhatOneSaysAndTheOtherDoesNot) {
  GridFileInfo a;
  a.transform.basis = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  a.metadata = {{"file_mem_bytes", "7"}, {"latvox_lattice", "bcc"}, {"latvox_origin", "0,0,0"}, {"name", "voxels"}};
  GridFileInfo b = a;
  b.metadata[0].second = "8";
  b.metadata[2].second = "0,0,0.0";
  EXPECT_THAT(CompareFields(a, b), IsEmpty());
  b.metadata[1].second = "fcc";
  b.metadata.emplace_back("latvox_shard", "0/2");
  b.transform.origin[2] = 0.1;
  const auto fields = CompareFields(a, b);
  ASSERT_EQ(fields.size(), 3u);
  EXPECT_EQ(fields[0].name, "latvox_lattice");
  EXPECT_EQ(fields[0].a + fields[0].b, "bccfcc");
  EXPECT_EQ(fields[1].name, "latvox_shard");
  EXPECT_EQ(fields[1].a + fields[1].b, "0/2");
  EXPECT_EQ(fields[2].name, "origin");
  EXPECT_EQ(fields[2].b, "0,0,0.10000000000000001");
}

// Distances within the plane equal those of the world.
TEST(LayerOf, IsTheLatticeWithinThePlane) {
  const GridTransform grids[] = {{{{0.2, 0, 0}, {0, 0.2, 0}, {0.1, 0.1, 0.1}}, {1, -2, 3}, 0.16},
                                 {{{0.3, 0.01, -0.02}, {0.05, 0.4, 0.03}, {-0.1, 0.07, 0.5}}, {0.1, 0.2, 0.3}, 0.39}};
  for (const GridTransform& grid : grids) {
    for (size_t axis = 0; axis < 3; ++axis) {
      const int32_t index = 7 - 5 * static_cast<int32_t>(axis);
      const Layer layer = LayerOf(grid, axis, index);
      EXPECT_NEAR(Dot(layer.right, layer.up), 0, 1e-12);
      for (const Vec2i& ij : {Vec2i{0, 0}, {1, 0}, {0, 1}, {-3, 5}}) {
        Vec3i ijk = {ij[0], ij[1], ij[1]};
        if (axis == 0) ijk[1] = ij[0];
        ijk[axis] = index;
        const Vec3d world = grid.ToWorld(ijk);
        const Vec2d plane = layer.grid.ToWorld(ij);
        EXPECT_NEAR(plane[0], Dot(world, layer.right), 1e-12);
        EXPECT_NEAR(plane[1], Dot(world, layer.up), 1e-12);
      }
      const auto& [a, b] = layer.grid.basis;
      EXPECT_NEAR(layer.grid.pixel_size * layer.grid.pixel_size, a[0] * b[1] - a[1] * b[0], 1e-12);
      EXPECT_GT(b[1], 0);
    }
  }
}

}  // namespace
}  // namespace latvox::client
