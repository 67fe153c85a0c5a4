#include <gmock/gmock.h>

#include "client/grid/openvdb_trees.h"
#include "client/tool/output/voxel_colors.h"
#include "latvox/grid/attribute_grids.h"
#include "latvox/grid/distance_grid.h"
#include "latvox/grid/grid_content.h"
#include "latvox/grid/openvdb_grid.h"
#include "tests/unit/client/files.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::HasSubstr;
using testing::IsEmpty;

class Content : public FilesTest {};

const GridTransform kBcc = {{{0.2, 0, 0}, {0, 0.2, 0}, {0.1, 0.1, 0.1}}, {1, -2, 3}, 0.15874010519681994};
// The order differs from that of files.
const std::vector<Brick> kBricks = {{{3, 0, 0}, {5, 0, 0, 0, 0, 0, 0, 1}}, {{-600, 0, 7}, {0, 0, 0, 2, 0, 0, 0, 0}}};

TEST_F(Content, NumbersStandByTheirVoxels) {
  const std::vector<uint32_t> numbers = {0x102030, 7, 0x0000FF, 8, 0xFF8000, 9, 0xFFFFFF, 6};
  AttributeGrids grids(kBcc, {Attribute::kColor, Attribute::kPart});
  ASSERT_TRUE(grids.Add({kBricks, 1, {}, numbers}).ok());
  ASSERT_TRUE(grids.Write(Path("o.vdb")).ok());
  const auto content = ReadGridContent(Path("o.vdb"));
  ASSERT_TRUE(content.ok()) << content.status();
  EXPECT_EQ(content->file.bricks.front().brick_ijk, kBricks[1].brick_ijk);
  EXPECT_THAT(content->attributes, ElementsAre(Attribute::kPart, Attribute::kColor));
  EXPECT_THAT(content->numbers, ElementsAre(6, 0xFFFFFF, 7, 0x102030, 8, 0x0000FF, 9, 0xFF8000));
  EXPECT_FALSE(content->band.has_value());
  const VoxelTraits traits = {content->attributes, content->band};
  EXPECT_EQ(DefaultColorBy(traits), ColorBy::kColor);
  EXPECT_THAT(*ColorsOf(content->Batch(), traits, ColorBy::kColor),
              ElementsAre(0xFFFFFF, 0x102030, 0x0000FF, 0xFF8000));
  EXPECT_THAT(*ColorsOf(content->Batch(), traits, ColorBy::kPart),
              ElementsAre(PaletteColor(6), PaletteColor(7), PaletteColor(8), PaletteColor(9)));
  EXPECT_THAT(*ColorsOf(content->Batch(), traits, ColorBy::kNone), IsEmpty());
  EXPECT_THAT(std::string(ColorsOf(content->Batch(), traits, ColorBy::kMaterial).status().message()),
              HasSubstr("no material"));
}

TEST_F(Content, DistancesAreThoseOfTheBand) {
  const std::vector<float> distances = {0.25F, -0.125F, 0, 0.5F};
  DistanceGrid grid(kBcc, 0.5, /*is_signed=*/true, /*whole=*/false);
  Certificate certificate;
  certificate.band = {0.75, true, "00"};
  grid.SetCertificate(certificate);
  ASSERT_TRUE(grid.Add({kBricks, 1, distances}).ok());
  ASSERT_TRUE(grid.Write(Path("o.vdb")).ok());
  const auto content = ReadGridContent(Path("o.vdb"));
  ASSERT_TRUE(content.ok()) << content.status();
  EXPECT_THAT(content->distances, ElementsAre(0.5F, 0.25F, -0.125F, 0));
  ASSERT_TRUE(content->band.has_value());
  EXPECT_EQ(content->band->width, 0.75);
  EXPECT_TRUE(content->band->is_signed);
  EXPECT_EQ(DefaultColorBy({{}, content->band}), ColorBy::kDistance);
}

TEST_F(Content, GridsOfOtherVoxelsAreRefused) {
  const auto refusal = [&](const openvdb::GridBase::Ptr& other) {
    VoxelGrid voxels(kBcc);
    EXPECT_TRUE(voxels.Add({kBricks, 1}).ok());
    openvdb::io::File(Path("o.vdb")).write({voxels.content().grid, other});
    return std::string(ReadGridContent(Path("o.vdb")).status().message());
  };
  const auto part = openvdb::Int32Grid::create();
  part->setName("part");
  EXPECT_THAT(refusal(part), HasSubstr("the grid \"part\" has other voxels than the grid \"voxels\""));
  const auto floats = openvdb::FloatGrid::create();
  floats->setName("material");
  EXPECT_THAT(refusal(floats), HasSubstr("the grid \"material\" is a Tree_float_5_4_3, not a Tree_int32_5_4_3"));
  const auto colors = openvdb::Vec3SGrid::create();
  colors->setName("color");
  for (const Vec3i& ijk : {Vec3i{24, 0, 0}, {24, 0, 2}, {31, 0, 0}, {-4797, 0, 57}}) {
    colors->tree().setValueOn(openvdb::Coord(ijk.data()), openvdb::Vec3s(0, 1.5F, 0));
  }
  EXPECT_THAT(refusal(colors), HasSubstr("no colors from 0 to 1"));
}

// The ends and middle of the maps are the published colors.
TEST(VoxelColors, DistancesRunOverTheWholeMap) {
  const Band with_sign = {2, false, true}, without = {2, false, false};
  const auto colors = [](const Band& band, const std::vector<float>& distances) {
    std::vector<uint32_t> found;
    for (const float distance : distances) found.push_back(DistanceColor(distance, band));
    return found;
  };
  EXPECT_THAT(colors(with_sign, {-2, 0, 2}), ElementsAre(0x053061, 0xF7F7F7, 0x67001F));
  EXPECT_THAT(colors(without, {0, 1, 2}), ElementsAre(0x440154, 0x21918C, 0xFDE725));
  EXPECT_THAT(colors(with_sign, {-3, 3}), ElementsAreArray(colors(with_sign, {-2, 2})));
  EXPECT_EQ(DistanceColor(0.125F, without), 0x461768u);  // halfway between the first two
}

TEST(VoxelColors, TwelveOfThePaletteDiffer) {
  std::set<uint32_t> colors;
  for (uint32_t number = 0; number < 12; ++number) colors.insert(PaletteColor(number));
  EXPECT_EQ(colors.size(), 12u);
  EXPECT_EQ(PaletteColor(12), PaletteColor(0));
}

}  // namespace
}  // namespace latvox::client
