#include "client/grid/link_grids.h"

#include <gmock/gmock.h>

#include <functional>
#include <limits>
#include <map>

#include "client/grid/grid_file.h"
#include "client/grid/openvdb_trees.h"
#include "latvox/grid/grid_content.h"
#include "tests/unit/client/fields.h"
#include "tests/unit/client/files.h"

namespace latvox::client {
namespace {

using testing::HasSubstr;

using Grids = std::map<std::string, openvdb::GridBase::Ptr>;

class LinkGridsTest : public FilesTest {
 protected:
  // Two voxels: the links of the first to 0,0,1 and of the second to 0,0,-1 are crossed.
  Grids MakeGrids() const {
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    const std::vector<Brick> bricks = {{{0, 0, -1}, {3}}};
    const std::vector<Vec3i> neighbors = {{0, 0, -1}, {0, 0, 1}};
    std::vector<FieldValues> fields = {ValuesOf<float>(Field::kLinks, {kNone, 0.25F, 0.75F, kNone}),
                                       ValuesOf<uint32_t>(Field::kLinkTriangles, {~0U, 7, 7, ~0U}),
                                       ValuesOf<uint32_t>(Field::kLinkCrossings, {0, 1, 1, 0})};
    for (FieldValues& values : fields) values.neighbors = neighbors.size();
    const auto set = openvdb::BoolGrid::create(false);
    set->setName("voxels");
    set->insertMeta("latvox_set", openvdb::StringMetadata("links"));
    for (const int k : {-8, -7}) set->tree().setValueOn({0, 0, k}, true);
    Grids grids = {{"voxels", set}};
    const LateGrids late = LinkGrids(bricks, fields, neighbors, *set);
    for (size_t n = 0; n < late.count; ++n) {
      const auto grid = late.make(n);
      grids[grid->getName()] = grid;
    }
    return grids;
  }

  absl::StatusOr<GridContent> ReadBack(const Grids& grids) const {
    openvdb::GridCPtrVec all;
    for (const auto& [name, grid] : grids) all.push_back(grid);
    EXPECT_TRUE(WriteGridFile(all, Path("l.vdb")).ok());
    return ReadGridContent(Path("l.vdb"));
  }
};

TEST_F(LinkGridsTest, VoxelsAreActiveWhereTheirLinkIsCrossed) {
  Grids grids = MakeGrids();
  ASSERT_EQ(grids.size(), 7U);
  const auto& up = static_cast<const openvdb::FloatGrid&>(*grids.at("link_0_0_1"));
  EXPECT_EQ(up.activeVoxelCount(), 1U);
  EXPECT_EQ(up.tree().getValue({0, 0, -8}), 0.25F);
  EXPECT_EQ(up.tree().getValue({0, 0, -7}), 0);
  const auto& triangles = static_cast<const openvdb::Int32Grid&>(*grids.at("link_triangle_0_0_-1"));
  EXPECT_EQ(triangles.tree().getValue({0, 0, -7}), 7);
  EXPECT_EQ(triangles.tree().getValue({0, 0, -8}), -1);
  const auto& crossings = static_cast<const openvdb::Int32Grid&>(*grids.at("link_crossings_0_0_-1"));
  EXPECT_EQ(crossings.tree().getValue({0, 0, -8}), 0);
  EXPECT_EQ(crossings.getMetadata<openvdb::StringMetadata>("latvox_set")->value(), "links");
  const auto content = ReadBack(grids);
  ASSERT_TRUE(content.ok()) << content.status();
  EXPECT_EQ(content->fields.size(), 3U);
  EXPECT_EQ(content->neighbors, (std::vector<Vec3i>{{0, 0, -1}, {0, 0, 1}}));
}

TEST_F(LinkGridsTest, FieldsThatContradictEachOtherAreErrors) {
  const auto integers = [](Grids& grids, const std::string& name) -> openvdb::Int32Tree& {
    return static_cast<openvdb::Int32Grid&>(*grids.at(name)).tree();
  };
  const struct {
    std::function<void(Grids&)> change;
    const char* says;
  } kCases[] = {
      {[](Grids& g) { g.erase("link_0_0_-1"); }, "l.vdb: lacks the grid \"link_0_0_-1\""},
      {[](Grids& g) { g.erase("link_crossings_0_0_1"); }, "l.vdb: lacks the grid \"link_crossings_0_0_1\""},
      {[](Grids& g) { g["link_0_0_1"] = g["voxels"]->deepCopyGrid(), g["link_0_0_1"]->setName("link_0_0_1"); },
       "l.vdb: the grid \"link_0_0_1\" is a Tree_bool_5_4_3, not a Tree_float_5_4_3"},
      {[&](Grids& g) {
         integers(g, "link_triangle_0_0_1").setValueOn({0, 0, -7}, 3);
       },
       "l.vdb: the grids of link_triangles have other voxels than those of links"},
      {[&](Grids& g) {
         integers(g, "link_crossings_0_0_1").setValueOff({0, 0, -8});
       },
       "l.vdb: the grids of link_crossings have other voxels than those of links"},
      {[&](Grids& g) {
         integers(g, "link_crossings_0_0_1").setValueOn({0, 0, -6}, 3);
       },
       "l.vdb: the grid \"link_crossings_0_0_1\" has voxels that the grid \"voxels\" lacks"},
      {[&](Grids& g) {
         integers(g, "link_crossings_0_0_1").setValueOn({0, 99, 0}, 3);
       },
       "l.vdb: the grid \"link_crossings_0_0_1\" has voxels that the grid \"voxels\" lacks"},
      {[&](Grids& g) {
         integers(g, "link_crossings_0_0_1").setValueOn({0, 0, -8}, 0);
       },
       "l.vdb: the grid \"link_crossings_0_0_1\" has values that are no link_crossings"},
      {[&](Grids& g) {
         integers(g, "link_triangle_0_0_1").setValueOn({0, 0, -8}, -1);
       },
       "l.vdb: the grid \"link_triangle_0_0_1\" has values that are no link_triangles"},
  };
  for (const auto& [change, says] : kCases) {
    Grids grids = MakeGrids();
    change(grids);
    const absl::Status status = ReadBack(grids).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(status.message()), HasSubstr(says));
  }
}

// Other programs may have such names.
TEST_F(LinkGridsTest, OtherNamesAreNoNeighbors) {
  const Grids grids = MakeGrids();
  for (const char* name :
       {"link_0_0", "link_0_0_1_", "link_0_0_+1", "link_00_0_1", "link_a_0_1", "blink_0_0_1", "link"}) {
    Grids more = grids;
    more[name] = grids.at("voxels")->deepCopyGrid();
    more[name]->setName(name);
    const auto content = ReadBack(more);
    ASSERT_TRUE(content.ok()) << content.status();
    EXPECT_EQ(content->neighbors.size(), 2U) << name;
  }
}

}  // namespace
}  // namespace latvox::client
