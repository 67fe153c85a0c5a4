// Grids of files as bricks, those of other programs among them.
#include <gmock/gmock.h>

#include <bit>
#include <string>
#include <vector>

#include "client/grid/openvdb_trees.h"
#include "latvox/grid/grid_content.h"
#include "latvox/grid/openvdb_grid.h"
#include "latvox/grid/voxel_grid.h"
#include "tests/unit/client/files.h"

namespace latvox::client {
namespace {

using testing::HasSubstr;

class GridReading : public FilesTest {};

const GridTransform kSkew = {{{0.3, 0.01, -0.02}, {0.05, 0.4, 0.03}, {-0.1, 0.07, 0.5}}, {0.1, 0.2, 0.3}, 0.39};

TEST_F(GridReading, FilesAreReadBackBrickByBrick) {
  VoxelGrid grid(kSkew);
  std::vector<Brick> bricks = {{{3, -1, 0}, {1, 2, 3, 4, 5, 6, 7, 8}}, {{-600, 0, 7}, {0, 0, 0, 0, 0, 0, 0, 1}}};
  ASSERT_TRUE(grid.Add({bricks, 1}).ok());
  ASSERT_TRUE(grid.Write(Path("o.vdb")).ok());
  const auto file = ReadGridFile(Path("o.vdb"));
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->bricks.size(), 2u);
  for (size_t n = 0; n < 2; ++n) {
    EXPECT_EQ(file->bricks[n].brick_ijk, bricks[1 - n].brick_ijk);
    EXPECT_EQ(file->bricks[n].mask, bricks[1 - n].mask);
  }
  EXPECT_EQ(file->info.active_voxels, 14u);
  EXPECT_NEAR(file->info.transform.basis.c[2], 0.5, 1e-15);
}

TEST_F(GridReading, VoxelsThatAreNotBooleanAreRefused) {
  openvdb::initialize();
  const auto refusal = [&](const openvdb::GridBase::Ptr& grid) {
    openvdb::io::File(Path("o.vdb")).write({grid});
    return std::string(ReadGridFile(Path("o.vdb")).status().message());
  };
  const auto numbers = openvdb::FloatGrid::create();
  numbers->setName("density");
  EXPECT_THAT(refusal(numbers),
              HasSubstr("the grid \"density\" is a Tree_float_5_4_3; voxels are read from a bool grid, and distances"));
  const auto vast = openvdb::BoolGrid::create();
  vast->fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(4095)), true);
  EXPECT_THAT(refusal(vast), HasSubstr("o.vdb: has active tiles of 68719476736 voxels, more than 17179869184"));
}

TEST_F(GridReading, OfSeveralGridsTheOneWithVoxelsIsRead) {
  openvdb::initialize();
  const auto named = [](openvdb::GridBase::Ptr grid, const char* name) {
    grid->setName(name);
    return grid;
  };
  const auto mask = openvdb::BoolGrid::create();
  mask->tree().setValueOn(openvdb::Coord(1, 2, 3));
  const auto read = [&](const openvdb::GridPtrVec& grids) {
    openvdb::io::File(Path("o.vdb")).write(grids);
    return ReadGridFile(Path("o.vdb"));
  };
  const auto density = named(openvdb::FloatGrid::create(), "density");  // before "mask"
  const auto only = read({density, named(mask->deepCopy(), "mask")});
  ASSERT_TRUE(only.ok()) << only.status();
  EXPECT_EQ(only->info.active_voxels, 1U);
  const auto several = read({named(mask->deepCopy(), "b"), named(openvdb::BoolGrid::create(), "a"), density});
  EXPECT_THAT(std::string(several.status().message()), HasSubstr("has the bool grids a, b; latvox reads the one with"));
  EXPECT_TRUE(read({named(openvdb::BoolGrid::create(), "a"), named(mask->deepCopy(), "voxels")}).ok());
  const auto distance = openvdb::FloatGrid::create();
  distance->tree().setValueOn(openvdb::Coord(0, 0, 0), 0.5F);
  distance->tree().setValueOn(openvdb::Coord(0, 0, 1), 0.5F);
  read({named(mask->deepCopy(), "a"), named(distance, "distance")}).IgnoreError();
  const auto band = ReadGridContent(Path("o.vdb"));
  ASSERT_TRUE(band.ok()) << band.status();
  EXPECT_TRUE(band->is_band);
  EXPECT_EQ(band->file.info.active_voxels, 2U);
}

TEST_F(GridReading, TilesOfOtherProgramsAreReadAsTheirVoxels) {
  openvdb::initialize();
  const auto solid = openvdb::BoolGrid::create();
  solid->fill(openvdb::CoordBBox(openvdb::Coord(-8), openvdb::Coord(9)), true);
  ASSERT_GT(solid->tree().activeTileCount(), 0u);
  openvdb::io::File(Path("o.vdb")).write({solid});
  const auto file = ReadGridFile(Path("o.vdb"));
  ASSERT_TRUE(file.ok()) << file.status();
  ASSERT_EQ(file->bricks.size(), 27u);
  size_t voxels = 0;
  for (const Brick& brick : file->bricks) {
    for (const uint64_t word : brick.mask) voxels += static_cast<size_t>(std::popcount(word));
  }
  EXPECT_EQ(voxels, 18u * 18 * 18);
  EXPECT_EQ(file->info.active_voxels, voxels);
}

}  // namespace
}  // namespace latvox::client
