// Parts with fields, joined, compared with a table of their voxels.
#include "client/grid/content_join.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <random>
#include <utility>

#include "latvox/for_each_voxel.h"

namespace latvox::client {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// Part and fraction of each voxel: four bytes and two.
using Table = std::map<Vec3i, std::pair<uint32_t, uint16_t>>;

template <class T>
void Append(T number, std::vector<std::byte>& bytes) {
  bytes.resize(bytes.size() + sizeof(T));
  std::memcpy(bytes.data() + bytes.size() - sizeof(T), &number, sizeof(T));
}

PartContent ToPart(const std::string& path, const Table& table) {
  std::map<Vec3i, Brick> bricks;
  for (const auto& [ijk, values] : table) {
    const Vec3i brick_ijk = {ijk[0] >> 3, ijk[1] >> 3, ijk[2] >> 3};
    Brick& brick = bricks.try_emplace(brick_ijk, Brick{brick_ijk, {}}).first->second;
    brick.mask[static_cast<size_t>(ijk[0] & 7)] |= uint64_t{1} << ((ijk[1] & 7) << 3 | (ijk[2] & 7));
  }
  PartContent part{path, {}};
  part.content.fields = {{Field::kPart, {}}, {Field::kFraction, {}}};
  for (const auto& [place, brick] : bricks) {
    part.content.file.bricks.push_back(brick);
    ForEachVoxel(brick, [&](const Vec3i& ijk) {
      Append(table.at(ijk).first, part.content.fields[0].bytes);
      Append(table.at(ijk).second, part.content.fields[1].bytes);
    });
  }
  return part;
}

Table ToTable(const JoinedContent& joined) {
  Table table;
  const BrickBatch all{joined.bricks, 1, joined.fields};
  ForEachVoxel(all, [&](const Voxel& voxel) {
    const auto values = std::pair(voxel.Of<uint32_t>(Field::kPart)[0], voxel.Of<uint16_t>(Field::kFraction)[0]);
    EXPECT_TRUE(table.emplace(voxel.ijk, values).second);
  });
  return table;
}

TEST(ContentJoin, PartsThatOverlapWithinBricks) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int32_t> place(-12, 12);
  Table whole;
  for (int n = 0; n < 3000; ++n) whole[{place(random), place(random), place(random)}] = {random(), random() & 0xffff};
  std::vector<Table> parts(4);
  for (const auto& each : whole) {
    parts[random() % 4].insert(each);
    parts[random() % 4].insert(each);
  }
  std::vector<PartContent> contents;
  size_t bricks = 0;
  for (const Table& part : parts) {
    contents.push_back(ToPart("part", part));
    bricks += contents.back().content.file.bricks.size();
  }
  const auto joined = JoinContents(contents, /*disjoint=*/false);
  ASSERT_TRUE(joined.ok()) << joined.status();
  EXPECT_EQ(ToTable(*joined), whole);
  EXPECT_GT(joined->shared_bricks, 0u);
  EXPECT_EQ(joined->shared_bricks, bricks - joined->bricks.size());
}

TEST(ContentJoin, ShardsThatShareABrick) {
  const std::vector<PartContent> parts = {ToPart("a.vdb", {{{8, 0, -1}, {}}}), ToPart("b.vdb", {{{9, 0, -1}, {}}})};
  EXPECT_TRUE(JoinContents(parts, /*disjoint=*/false).ok());
  EXPECT_THAT(std::string(JoinContents(parts, /*disjoint=*/true).status().message()),
              AllOf(HasSubstr("b.vdb: holds brick 1,0,-1, and so does a.vdb")));
}

TEST(ContentJoin, ValuesThatDiffer) {
  const PartContent a = ToPart("a.vdb", {{{-3, 4, 70}, {1, 2}}}), b = ToPart("b.vdb", {{{-3, 4, 70}, {1, 3}}});
  EXPECT_EQ(JoinContents({a, b}, /*disjoint=*/false).status().message(),
            "b.vdb: voxel -3,4,70 has another fraction than in a.vdb");
}

TEST(ContentJoin, FieldsThatDiffer) {
  const PartContent a = ToPart("a.vdb", {{{0, 0, 0}, {1, 2}}});
  PartContent b = ToPart("b.vdb", {{{0, 0, 1}, {1, 2}}});
  b.content.fields.pop_back();
  EXPECT_EQ(JoinContents({a, b}, /*disjoint=*/false).status().message(),
            "b.vdb: its fields are part, but part,fraction in a.vdb");
  b.content.fields.clear();
  EXPECT_EQ(JoinContents({a, b}, /*disjoint=*/false).status().message(),
            "b.vdb: its fields are absent, but part,fraction in a.vdb");
}

TEST(ContentJoin, NeighborsThatDiffer) {
  PartContent a = ToPart("a.vdb", {}), b = ToPart("b.vdb", {});
  a.content.fields = b.content.fields = {{Field::kLinks, {}, 2}};
  a.content.neighbors = {{-1, 0, 2}, {1, 0, -2}};
  b.content.neighbors = {{-1, 0, 0}, {1, 0, 0}};
  EXPECT_EQ(JoinContents({a, b}, /*disjoint=*/false).status().message(),
            "b.vdb: its fields are links to -1,0,0 1,0,0, but links to -1,0,2 1,0,-2 in a.vdb");
  b.content.neighbors = a.content.neighbors;
  const auto joined = JoinContents({a, b}, /*disjoint=*/false);
  ASSERT_TRUE(joined.ok()) << joined.status();
  EXPECT_EQ(joined->neighbors, a.content.neighbors);
  EXPECT_EQ(joined->fields, a.content.fields);
}

TEST(ContentJoin, LabelsThatDiffer) {
  PartContent a = ToPart("a.vdb", {}), b = ToPart("b.vdb", {});
  a.content.fields = {{Field::kLabelFractions, {}, 0, {7, 3}}};
  b.content.fields = {{Field::kLabelFractions, {}, 0, {3}}};
  EXPECT_EQ(JoinContents({a, b}, /*disjoint=*/false).status().message(),
            "b.vdb: its fields are label_fractions of 3, but label_fractions of 7 3 in a.vdb");
}

}  // namespace
}  // namespace latvox::client
