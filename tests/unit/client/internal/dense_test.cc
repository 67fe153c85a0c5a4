// Visits of voxels, and dense arrays.
#include "latvox/dense.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "latvox/error.h"
#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Voxels (-8, -7, 3), (-6, -8, 0), (-6, -8, 1) and (1, 0, 7), with distances and two attributes each.
Voxelization Four() {
  Voxelization all;
  all.bricks = {{{-1, -1, 0}, {uint64_t{1} << 11, 0, 3}}, {{0, 0, 0}, {0, uint64_t{1} << 7}}};
  all.values = {0.5F, -1, 0, 2};
  all.attributes = {10, 11, 20, 21, 30, 31, 40, 41};
  all.accepted.index_box = IndexBox{{-8, -8, 0}, {2, 1, 8}};
  return all;
}

TEST(ForEachVoxel, VisitsTheVoxelsOfABrickInOrder) {
  const Voxelization all = Four();
  std::vector<Vec3i> visited;
  ForEachVoxel(all.bricks[0], [&](const Vec3i& ijk) { visited.push_back(ijk); });
  EXPECT_THAT(visited, ElementsAre(Vec3i{-8, -7, 3}, Vec3i{-6, -8, 0}, Vec3i{-6, -8, 1}));
  EXPECT_EQ(CountVoxels(all.bricks[0]), 3U);
}

TEST(ForEachVoxel, GivesEachVoxelOfAResultItsDistanceAndAttributes) {
  const Voxelization all = Four();
  std::vector<Vec3i> visited;
  std::vector<float> distances;
  std::vector<uint32_t> attributes;
  ForEachVoxel(all, [&](const Voxel& voxel) {
    visited.push_back(voxel.ijk);
    distances.push_back(voxel.distance.value());
    ASSERT_EQ(voxel.attributes.size(), 2U);
    attributes.insert(attributes.end(), voxel.attributes.begin(), voxel.attributes.end());
  });
  EXPECT_THAT(visited, ElementsAre(Vec3i{-8, -7, 3}, Vec3i{-6, -8, 0}, Vec3i{-6, -8, 1}, Vec3i{1, 0, 7}));
  EXPECT_EQ(distances, all.values);
  EXPECT_EQ(attributes, all.attributes);
}

TEST(ForEachVoxel, OfASurfaceHasNeither) {
  const std::vector<Brick> bricks = Four().bricks;
  size_t visits = 0;
  ForEachVoxel(BrickBatch{.bricks = bricks}, [&](const Voxel& voxel) {
    ++visits;
    EXPECT_FALSE(voxel.distance.has_value());
    EXPECT_THAT(voxel.attributes, IsEmpty());
  });
  EXPECT_EQ(visits, 4U);
}

TEST(Dense, HasOneByteForEachPointInTheOrderThatItStates) {
  const Voxelization all = Four();
  const auto dense = ToDense(all.bricks, *all.accepted.index_box);
  ASSERT_TRUE(dense.ok()) << dense.status();
  EXPECT_THAT(dense->shape, ElementsAre(10, 9, 8));
  EXPECT_THAT(dense->strides, ElementsAre(72, 8, 1));
  EXPECT_EQ(dense->box, *all.accepted.index_box);
  ASSERT_EQ(dense->voxels.size(), 720U);
  EXPECT_EQ(dense->IndexOf({-8, -8, 0}), 0U);
  EXPECT_EQ(dense->IndexOf({1, 0, 7}), 719U);
  std::vector<size_t> set;
  for (size_t n = 0; n < dense->voxels.size(); ++n) {
    if (dense->voxels[n] != 0) set.push_back(n);
    EXPECT_LE(dense->voxels[n], 1);
  }
  EXPECT_THAT(set, ElementsAre(8 + 3, 2 * 72, 2 * 72 + 1, 719));
  EXPECT_THAT(dense->distances, IsEmpty());
  EXPECT_THAT(dense->attributes, IsEmpty());
}

TEST(Dense, HasDistancesAndAttributesAtVoxels) {
  const Voxelization all = Four();
  const auto dense = ToDense(all);
  ASSERT_TRUE(dense.ok()) << dense.status();
  EXPECT_EQ(dense->box, *all.accepted.index_box);
  ASSERT_EQ(dense->distances.size(), 720U);
  EXPECT_EQ(dense->distances[dense->IndexOf({-6, -8, 0})], -1);
  EXPECT_TRUE(std::isnan(dense->distances[dense->IndexOf({0, 0, 0})]));
  EXPECT_EQ(dense->attributes_per_voxel, 2U);
  ASSERT_EQ(dense->attributes.size(), 1440U);
  EXPECT_EQ(dense->attributes[2 * dense->IndexOf({1, 0, 7}) + 1], 41U);
  EXPECT_EQ(dense->attributes[2 * dense->IndexOf({0, 0, 7}) + 1], 0U);
}

TEST(Dense, LeavesOutVoxelsOutsideOfTheBox) {
  const auto dense = ToDense(Four(), IndexBox{{-6, -8, 1}, {-5, -7, 3}});
  ASSERT_TRUE(dense.ok()) << dense.status();
  EXPECT_THAT(dense->voxels, ElementsAre(1, 0));
  EXPECT_EQ(dense->distances[0], 0);
  EXPECT_THAT(dense->attributes, ElementsAre(30, 31, 0, 0));
}

TEST(Dense, OfNothingIsEmpty) {
  const auto dense = ToDense(Voxelization{});
  ASSERT_TRUE(dense.ok()) << dense.status();
  EXPECT_THAT(dense->shape, ElementsAre(0, 0, 0));
  EXPECT_THAT(dense->voxels, IsEmpty());
}

TEST(Dense, RefusesABoxThatIsTooLargeOrUpsideDown) {
  const IndexBox all{{INT32_MIN, INT32_MIN, INT32_MIN}, {INT32_MAX, INT32_MAX, INT32_MAX}};
  const absl::Status large = ToDense(Four(), all).status();
  EXPECT_EQ(large.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(GetErrorDetails(large).field, "box");
  EXPECT_EQ(GetErrorDetails(large).limit, "1073741824");
  const IndexBox hundred{{0, 0, 0}, {10, 10, 1}};
  EXPECT_TRUE(ToDense(Four(), hundred, 100).ok());
  const absl::Status over = ToDense(Four(), hundred, 99).status();
  EXPECT_EQ(over.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(over.message(), "box: 10 x 10 x 1 points exceed the limit of 99");
  const absl::Status reversed = ToDense(Four(), IndexBox{{0, 5, 0}, {1, 4, 1}}).status();
  EXPECT_EQ(reversed.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(reversed.message(), "box.max[1]: 4 is below box.min, 5");
  EXPECT_EQ(GetErrorDetails(reversed).value, "4");
}

}  // namespace
}  // namespace latvox::client
