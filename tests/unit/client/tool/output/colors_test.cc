#include <gmock/gmock.h>

#include <limits>

#include "client/grid/openvdb_trees.h"
#include "client/tool/output/labels.h"
#include "client/tool/output/picture_scene.h"
#include "client/tool/output/voxel_colors.h"
#include "client/tool/view/paints.h"
#include "latvox/grid/distance_grid.h"
#include "latvox/grid/field_grids.h"
#include "latvox/grid/grid_content.h"
#include "latvox/grid/openvdb_grid.h"
#include "tests/unit/client/fields.h"
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
  const std::vector<FieldValues> fields{
      ValuesOf<uint8_t>(Field::kColor, {0x10, 0x20, 0x30, 0, 0, 0xFF, 0xFF, 0x80, 0, 0xFF, 0xFF, 0xFF}),
      ValuesOf<uint32_t>(Field::kPart, {7, 8, 9, 6})};
  FieldGrids grids(kBcc, {Field::kColor, Field::kPart});
  ASSERT_TRUE(grids.Add({kBricks, 1, fields}).ok());
  ASSERT_TRUE(grids.Write(Path("o.vdb")).ok());
  const auto content = ReadGridContent(Path("o.vdb"));
  ASSERT_TRUE(content.ok()) << content.status();
  EXPECT_EQ(content->file.bricks.front().brick_ijk, kBricks[1].brick_ijk);
  ASSERT_EQ(content->fields.size(), 2U);
  EXPECT_EQ(content->fields[0], ValuesOf<uint32_t>(Field::kPart, {6, 7, 8, 9}));
  EXPECT_EQ(content->fields[1].field, Field::kColor);
  EXPECT_FALSE(content->is_band || content->distances);
  const VoxelTraits traits = TraitsOf(*content);
  EXPECT_EQ(DefaultColorBy(traits), ColorBy::kColor);
  EXPECT_THAT(*ColorsOf(content->Batch(), traits, ColorBy::kColor),
              ElementsAre(0xFFFFFF, 0x102030, 0x0000FF, 0xFF8000));
  EXPECT_THAT(*ColorsOf(content->Batch(), traits, ColorBy::kPart),
              ElementsAre(PaletteColor(6), PaletteColor(7), PaletteColor(8), PaletteColor(9)));
  EXPECT_THAT(*ColorsOf(content->Batch(), traits, ColorBy::kNone), IsEmpty());
  EXPECT_THAT(std::string(ColorsOf(content->Batch(), traits, ColorBy::kMaterial).status().message()),
              HasSubstr("no material"));
}

TEST_F(Content, FieldsOfTheNearestTriangleGiveColors) {
  const std::vector<FieldValues> fields{ValuesOf<uint32_t>(Field::kTriangle, {0, 12, 5, 7}),
                                        ValuesOf<float>(Field::kPoint, {0, 0, 1, 0, 0, 1, 0.5F, 0.5F}),
                                        ValuesOf<float>(Field::kNormal, {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, 0, -1})};
  const BrickBatch batch{kBricks, 1, fields};
  const VoxelTraits traits{{Field::kTriangle, Field::kPoint, Field::kNormal}};
  EXPECT_EQ(DefaultColorBy(traits), ColorBy::kNone);
  EXPECT_THAT(*ColorsOf(batch, traits, ColorBy::kTriangle),
              ElementsAre(PaletteColor(0), PaletteColor(0), PaletteColor(5), PaletteColor(7)));
  EXPECT_THAT(*ColorsOf(batch, traits, ColorBy::kPoint), ElementsAre(0xFF0000, 0x00FF00, 0x0000FF, 0x008080));
  EXPECT_THAT(*ColorsOf(batch, traits, ColorBy::kNormal), ElementsAre(0xFF8080, 0x008080, 0x80FF80, 0x808000));
}

TEST_F(Content, LinksGiveColorsByTheLeastShareTheFirstTriangleAndTheMostCrossings) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  constexpr uint32_t kGray = 0xBBBBBB;
  std::vector<FieldValues> fields{ValuesOf<float>(Field::kLinks, {1, kNone, kNone, 0.5F, 0x1p-126F, 1, kNone, kNone}),
                                  ValuesOf<uint32_t>(Field::kLinkTriangles, {3, ~0U, ~0U, 0, 13, 2, ~0U, ~0U}),
                                  ValuesOf<uint32_t>(Field::kLinkCrossings, {1, 0, 0, 2, 4, 3, 0, 0})};
  for (FieldValues& values : fields) values.neighbors = 2;
  const BrickBatch batch{kBricks, 1, fields};
  const VoxelTraits traits{{Field::kLinks, Field::kLinkTriangles, Field::kLinkCrossings}};
  EXPECT_EQ(DefaultColorBy(traits), ColorBy::kNone);
  EXPECT_THAT(*ColorsOf(batch, traits, ColorBy::kLinks), ElementsAre(0xFDE725, 0x21918C, 0x440154, kGray));
  EXPECT_THAT(*ColorsOf(batch, traits, ColorBy::kLinkTriangles),
              ElementsAre(PaletteColor(3), PaletteColor(0), PaletteColor(2), kGray));
  EXPECT_THAT(*ColorsOf(batch, traits, ColorBy::kLinkCrossings),
              ElementsAre(PaletteColor(1), PaletteColor(2), PaletteColor(4), kGray));
}

TEST_F(Content, FractionsGiveColorsByThePointsOfACell) {
  const std::vector<FieldValues> fields{ValuesOf<uint16_t>(Field::kFraction, {0, 8, 4, 27})};
  const BrickBatch batch{kBricks, 1, fields};
  EXPECT_THAT(*ColorsOf(batch, {{Field::kFraction}, {}, 8}, ColorBy::kFraction),
              ElementsAre(0x440154, 0xFDE725, 0x21918C, 0xFDE725));
  EXPECT_FALSE(ColorsOf(batch, {{Field::kFraction}}, ColorBy::kFraction).ok());
  GridContent content;
  for (const char* n : {"", "1", "17", "x"}) {
    content.file.info.metadata = {{"latvox_fraction_n", n}};
    EXPECT_EQ(TraitsOf(content).points_of_cell, 0U) << n;
  }
  content.file.info.metadata = {{"latvox_fraction_n", "16"}};
  EXPECT_EQ(TraitsOf(content).points_of_cell, 4096U);
}

TEST_F(Content, FractionsOfLabelsMixTheirColors) {
  FieldValues fractions = ValuesOf<uint16_t>(Field::kLabelFractions, {8, 0, 0, 0, 4, 4, 2, 2});
  fractions.labels = {3, 12};
  const std::vector<FieldValues> fields{fractions};
  const BrickBatch batch{kBricks, 1, fields};
  // 0xF0E442 is the color of label 3, and 0xE69F00 that of label 12. The rest of a cell is white.
  EXPECT_THAT(*ColorsOf(batch, {{Field::kLabelFractions}, {}, 8}, ColorBy::kLabelFractions),
              ElementsAre(0xF0E442, 0xFFFFFF, 0xEBC221, 0xF5E090));
  EXPECT_FALSE(ColorsOf(batch, {{Field::kLabelFractions}}, ColorBy::kLabelFractions).ok());
}

TEST(Labels, HaveFractionsAloneAndTogether) {
  FieldValues fractions = ValuesOf<uint16_t>(Field::kLabelFractions, {8, 0, 1, 2, 3, 4});
  fractions.labels = {3, 12, 5};
  EXPECT_EQ(FractionOf(fractions, {{12}}), ValuesOf<uint16_t>(Field::kFraction, {0, 3}));
  EXPECT_EQ(FractionOf(fractions, {{5, 3, 99}}), ValuesOf<uint16_t>(Field::kFraction, {9, 6}));
}

TEST(Labels, HaveTheNamesOfTheFieldThatTheRequestNames) {
  GridFileInfo info;
  info.metadata = {{"latvox_part_names", R"(["lid"])"}, {"latvox_material_names", R"(["steel"])"}};
  EXPECT_EQ(NameOfLabel(info, 0), "lid");
  for (const char* request : {R"({"labels":"part"})", "{}", "[]", "x"}) {
    info.metadata.resize(2);
    info.metadata.emplace_back("latvox_request", request);
    EXPECT_EQ(NameOfLabel(info, 0), "lid") << request;
  }
  info.metadata.back().second = R"({"labels":"material"})";
  EXPECT_EQ(NameOfLabel(info, 0), "steel");
  EXPECT_EQ(NameOfLabel(info, 1), "");
}

TEST(Paints, AreForAllLabelsAndForEach) {
  GridContent content;
  content.file.info.metadata = {{"latvox_fraction_n", "2"}, {"latvox_part_names", R"(["", "lid"])"}};
  content.fields = {ValuesOf<uint16_t>(Field::kLabelFractions, {8, 0, 4, 2})};
  content.fields[0].labels = {7, 1};
  const auto paints = PaintsOf(content);
  ASSERT_TRUE(paints.ok()) << paints.status();
  ASSERT_EQ(paints->size(), 3U);
  EXPECT_TRUE((*paints)[0].is_mix && (*paints)[0].values.empty());
  EXPECT_THAT((std::vector{(*paints)[0].name, (*paints)[1].name, (*paints)[2].name}),
              ElementsAre("label_fractions", "fraction_7", "fraction_1 (lid)"));
  EXPECT_EQ((*paints)[1].values, std::string("\x8\0\0\0\4\0\0\0", 8));
  EXPECT_EQ((*paints)[2].values, std::string("\0\0\0\0\2\0\0\0", 8));
  EXPECT_TRUE((*paints)[2].is_ramp);
}

TEST(Paints, AreForEveryField) {
  for (const FieldFacts& facts : kFields) {
    GridContent content;
    content.file.info.metadata = {{"latvox_fraction_n", "2"}};
    content.distances = DistanceRange{1, false};
    FieldValues values{facts.field, {}, facts.is_of_links() ? size_t{2} : 0};
    if (facts.is_of_labels()) values.labels = {1, 2};
    values.bytes.resize(values.bytes_of_voxel());
    content.fields = {values};
    const auto paints = PaintsOf(content);
    ASSERT_TRUE(paints.ok()) << paints.status();
    ASSERT_FALSE(paints->empty()) << facts.name;
    const Paint& paint = paints->front();
    EXPECT_EQ(paint.name, facts.name);
    EXPECT_EQ(paint.bytes.size(), 3U);
    EXPECT_FALSE(paint.legend.empty());
    if (!paint.values.empty()) {
      EXPECT_EQ(paint.values.size(), 4 * paint.components) << facts.name;
    }
    EXPECT_EQ(paint.components, facts.field == Field::kPoint ? 2U : facts.field == Field::kNormal ? 3U : 1U);
  }
}

TEST(Paints, AreLimited) {
  GridContent content;
  content.file.info.metadata = {{"latvox_fraction_n", "2"}};
  content.file.info.active_voxels = kMaxPageColors / 3;
  content.fields = {{Field::kLabelFractions, {}, 0, {7, 1}}};
  EXPECT_TRUE(PaintsOf(content).ok());
  ++content.file.info.active_voxels;
  EXPECT_THAT(std::string(PaintsOf(content).status().message()),
              HasSubstr("6666667 voxels with 3 choices of colors exceed the limit of 20000000 of a page"));
}

TEST_F(Content, ASkinKeepsTheColorsOfItsVoxels) {
  const std::vector<FieldValues> fields{ValuesOf<float>(Field::kDistance, {0.25F, -0.125F, 0.75F, 0.5F})};
  std::vector<uint32_t> colors{1, 2, 3, 4};
  const std::vector<Brick> skin = SkinOf({kBricks, 1, fields}, 0.5, colors);
  ASSERT_EQ(skin.size(), 2U);
  EXPECT_EQ(CountVoxels(skin[0]), 2U);
  EXPECT_THAT(colors, ElementsAre(1, 2, 4));
}

TEST_F(Content, DistancesAreThoseOfTheBand) {
  const std::vector<FieldValues> fields{ValuesOf<float>(Field::kDistance, {0.25F, -0.125F, 0, 0.5F})};
  DistanceGrid grid(kBcc, 0.5, /*is_signed=*/true, /*whole=*/false);
  Certificate certificate;
  certificate.band = {0.75};
  certificate.fields = {{Field::kDistance, "00"}};
  certificate.signed_distance = true;
  grid.SetCertificate(certificate);
  ASSERT_TRUE(grid.Add({kBricks, 1, fields}).ok());
  ASSERT_TRUE(grid.Write(Path("o.vdb")).ok());
  const auto content = ReadGridContent(Path("o.vdb"));
  ASSERT_TRUE(content.ok()) << content.status();
  EXPECT_THAT(content->fields.at(0).As<float>(), ElementsAre(0.5F, 0.25F, -0.125F, 0));
  EXPECT_TRUE(content->is_band);
  EXPECT_EQ(content->distances, (DistanceRange{0.75, true}));
  EXPECT_EQ(DefaultColorBy(TraitsOf(*content)), ColorBy::kDistance);
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
  EXPECT_THAT(refusal(colors), HasSubstr("has values that are no color"));
}

// The ends and middle of the maps are the published colors.
TEST(VoxelColors, DistancesRunOverTheWholeMap) {
  const DistanceRange with_sign = {2, true}, without = {2, false};
  const auto colors = [](const DistanceRange& range, const std::vector<float>& distances) {
    std::vector<uint32_t> found;
    for (const float distance : distances) found.push_back(DistanceColor(distance, range));
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
