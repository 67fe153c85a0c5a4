// Grids of files as bricks, those of other programs among them.
#include <gmock/gmock.h>

#include <bit>
#include <string>
#include <vector>

#include "client/grid/openvdb_trees.h"
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
