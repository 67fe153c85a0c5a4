// Visits of voxels, and dense arrays.
#include "latvox/dense.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "latvox/error.h"
#include "latvox/for_each_voxel.h"
#include "tests/unit/client/fields.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Voxels (-8, -7, 3), (-6, -8, 0), (-6, -8, 1) and (1, 0, 7), with distances and parts.
Voxelization Four() {
  Voxelization all;
  all.bricks = {{{-1, -1, 0}, {uint64_t{1} << 11, 0, 3}}, {{0, 0, 0}, {0, uint64_t{1} << 7}}};
  all.fields = {ValuesOf<float>(Field::kDistance, {0.5F, -1, 0, 2}),
                ValuesOf<uint32_t>(Field::kPart, {10, 20, 30, 40})};
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

TEST(ForEachVoxel, GivesEachVoxelOfAResultItsFields) {
  const Voxelization all = Four();
  std::vector<Vec3i> visited;
  std::vector<float> distances;
  std::vector<uint32_t> parts;
  ForEachVoxel(all, [&](const Voxel& voxel) {
    visited.push_back(voxel.ijk);
    ASSERT_EQ(voxel.Of<float>(Field::kDistance).size(), 1U);
    distances.push_back(voxel.Of<float>(Field::kDistance)[0]);
    parts.push_back(voxel.Of<uint32_t>(Field::kPart)[0]);
    EXPECT_THAT(voxel.Of<float>(Field::kNormal), IsEmpty());
  });
  EXPECT_THAT(visited, ElementsAre(Vec3i{-8, -7, 3}, Vec3i{-6, -8, 0}, Vec3i{-6, -8, 1}, Vec3i{1, 0, 7}));
  EXPECT_THAT(distances, ElementsAre(0.5F, -1, 0, 2));
  EXPECT_THAT(parts, ElementsAre(10, 20, 30, 40));
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
  EXPECT_THAT(dense->fields, IsEmpty());
}

TEST(Dense, HasFieldsAtVoxels) {
  const Voxelization all = Four();
  const auto dense = ToDense(all);
  ASSERT_TRUE(dense.ok()) << dense.status();
  EXPECT_EQ(dense->box, *all.accepted.index_box);
  const auto distances = dense->fields[0].As<float>();
  ASSERT_EQ(distances.size(), 720U);
  EXPECT_EQ(distances[dense->IndexOf({-6, -8, 0})], -1);
  EXPECT_TRUE(std::isnan(distances[dense->IndexOf({0, 0, 0})]));
  const auto parts = dense->fields[1].As<uint32_t>();
  ASSERT_EQ(parts.size(), 720U);
  EXPECT_EQ(parts[dense->IndexOf({1, 0, 7})], 40U);
  EXPECT_EQ(parts[dense->IndexOf({0, 0, 7})], 0xFFFFFFFF);
}

TEST(Dense, LeavesOutVoxelsOutsideOfTheBox) {
  const auto dense = ToDense(Four(), IndexBox{{-6, -8, 1}, {-5, -7, 3}});
  ASSERT_TRUE(dense.ok()) << dense.status();
  EXPECT_THAT(dense->voxels, ElementsAre(1, 0));
  EXPECT_EQ(dense->fields[0].As<float>()[0], 0);
  EXPECT_THAT(dense->fields[1].As<uint32_t>(), ElementsAre(30, 0xFFFFFFFF));
}

TEST(Dense, HasTheFieldsOfABatchAlone) {
  const Voxelization all = Four();
  const IndexBox box{{-6, -8, 1}, {-5, -7, 3}};
  const auto dense = ToDense(BrickBatch{.bricks = all.bricks, .fields = std::span(all.fields).subspan(1)}, box);
  ASSERT_TRUE(dense.ok()) << dense.status();
  EXPECT_THAT(dense->voxels, ElementsAre(1, 0));
  ASSERT_EQ(dense->fields.size(), 1);
  EXPECT_THAT(dense->fields[0].As<uint32_t>(), ElementsAre(30, 0xFFFFFFFF));
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
