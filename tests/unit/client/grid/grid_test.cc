#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "client/grid/openvdb_trees.h"
#include "latvox/error.h"
#include "latvox/grid/distance_grid.h"
#include "latvox/grid/field_grids.h"
#include "latvox/grid/grid_content.h"
#include "latvox/grid/openvdb_grid.h"
#include "latvox/grid/voxel_grid.h"
#include "tests/unit/client/fields.h"
#include "tests/unit/client/files.h"

namespace latvox::client {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Key;
using testing::Not;
using testing::Pair;

class Grid : public FilesTest {};

const GridTransform kBcc = {{{0.2, 0, 0}, {0, 0.2, 0}, {0.1, 0.1, 0.1}}, {1, -2, 3}, 0.15874010519681994};
const GridTransform kSkew = {{{0.3, 0.01, -0.02}, {0.05, 0.4, 0.03}, {-0.1, 0.07, 0.5}}, {0.1, 0.2, 0.3}, 0.39};
const GridTransform kCubes = {{{0.25, 0, 0}, {0, 0.25, 0}, {0, 0, 0.25}}, {-1, 0, 1}, 0.25};

// Each of the 512 voxels alone in a brick.
TEST_F(Grid, EveryBitOfAMaskIsTheVoxelThatTheContractSays) {
  for (int x = 0; x < 8; ++x) {
    for (int y = 0; y < 8; ++y) {
      for (int z = 0; z < 8; ++z) {
        VoxelGrid grid(kBcc);
        Brick brick{{-3, 0, 5}, {}};
        brick.mask[static_cast<size_t>(x)] = uint64_t{1} << (y << 3 | z);
        ASSERT_TRUE(grid.Add({{&brick, 1}, 1}).ok());
        const openvdb::BoolGrid& vdb = *grid.content().grid;
        ASSERT_EQ(vdb.activeVoxelCount(), 1u);
        const openvdb::Coord ijk(-24 + x, y, 40 + z);
        ASSERT_TRUE(vdb.tree().isValueOn(ijk));
        ASSERT_TRUE(vdb.tree().getValue(ijk));
      }
    }
  }
}

TEST_F(Grid, ActiveVoxelsAreTheBitsOfAllBricksAndInactiveOnesAreFalse) {
  VoxelGrid grid(kBcc);
  std::vector<Brick> bricks;
  uint64_t bits = 0;
  for (int n = 0; n < 100; ++n) {
    Brick brick{{n % 5, n / 5 % 5, n / 25}, {}};
    for (uint64_t& word : brick.mask) word = 0x9E3779B97F4A7C15 * (++bits);
    bricks.push_back(brick);
  }
  bits = 0;
  for (const Brick& brick : bricks) {
    for (const uint64_t word : brick.mask) bits += static_cast<uint64_t>(__builtin_popcountll(word));
  }
  ASSERT_TRUE(grid.Add({bricks, 1}).ok());
  EXPECT_EQ(grid.CountActiveVoxels(), bits);
  EXPECT_EQ(grid.content().grid->tree().leafCount(), bricks.size());
  for (auto value = grid.content().grid->cbeginValueAll(); value; ++value) {
    ASSERT_EQ(value.isValueOn(), value.getValue());
  }
}

TEST_F(Grid, IndexToWorldIsTheSamplingMatrixOnEveryLattice) {
  for (const GridTransform& transform : {kBcc, kSkew, kCubes}) {
    const VoxelGrid grid(transform);
    for (const Vec3i& ijk : {Vec3i{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-7, 11, 1000}}) {
      const openvdb::Vec3d world =
          grid.content().grid->transform().indexToWorld(openvdb::Coord(ijk[0], ijk[1], ijk[2]));
      const Vec3d expected = transform.ToWorld(ijk);
      for (int m = 0; m < 3; ++m) {
        EXPECT_NEAR(world[m], expected[static_cast<size_t>(m)], 1e-12 * (1 + std::abs(world[m])));
      }
    }
  }
}

TEST_F(Grid, FilesKeepVoxelsTransformAndCertificate) {
  VoxelGrid grid(kSkew);
  Brick brick{{-1, 2, 3}, {}};
  brick.mask[4] = 3;
  ASSERT_TRUE(grid.Add({{&brick, 1}, 1}).ok());
  Certificate certificate;
  certificate.lattice = "basis";
  certificate.separability = 1;
  certificate.digest = "0123456789abcdef0123456789abcdef";
  grid.SetCertificate(certificate);
  ASSERT_TRUE(grid.Write(Path("g.vdb")).ok());
  const auto info = ReadGridFileInfo(Path("g.vdb"));
  ASSERT_TRUE(info.ok()) << info.status();
  EXPECT_EQ(info->name, "voxels");
  EXPECT_EQ(info->value_type, "bool");
  EXPECT_EQ(info->active_voxels, 2u);
  EXPECT_EQ(info->active_box, (IndexBox{{-4, 16, 24}, {-3, 17, 26}}));
  EXPECT_EQ(info->transform.basis, kSkew.basis);
  EXPECT_EQ(info->transform.origin, kSkew.origin);
  EXPECT_THAT(info->metadata, Contains(Pair("latvox_lattice", "basis")));
  EXPECT_THAT(info->metadata, Contains(Pair("latvox_separability", "1")));
  EXPECT_THAT(info->metadata, Contains(Pair("latvox_digest", certificate.digest)));
  const auto digest = ReadGridFileDigest(Path("g.vdb"));
  ASSERT_TRUE(digest.ok()) << digest.status();
  EXPECT_EQ(*digest, certificate.digest);
}

TEST_F(Grid, WarningsAreMetadataOfEveryGrid) {
  const std::vector<Warning> warnings = {{"NO_END", "cut \"short\"", "line 7"}, {"FEW_VOXELS", "small"}};
  const char* const kText = R"([{"code":"NO_END","message":"cut \"short\"","element":"line 7"},)"
                            R"({"code":"FEW_VOXELS","message":"small","element":""}])";
  VoxelGrid voxels(kCubes);
  voxels.SetWarnings({});
  ASSERT_TRUE(voxels.Write(Path("none.vdb")).ok());
  EXPECT_THAT(ReadGridFileInfo(Path("none.vdb"))->metadata, Not(Contains(Key("latvox_warnings"))));
  voxels.SetWarnings(warnings);
  ASSERT_TRUE(voxels.Write(Path("voxels.vdb")).ok());
  DistanceGrid distances(kCubes, 1, false, true);
  distances.SetWarnings(warnings);
  ASSERT_TRUE(distances.Write(Path("distances.vdb")).ok());
  FieldGrids fields(kCubes, {Field::kPart});
  fields.SetWarnings(warnings);
  ASSERT_TRUE(fields.Write(Path("fields.vdb")).ok());
  for (const char* name : {"voxels.vdb", "distances.vdb", "fields.vdb"}) {
    EXPECT_THAT(ReadGridFileInfo(Path(name))->metadata, Contains(Pair("latvox_warnings", kText))) << name;
  }
}

// A shell of six voxels around one that is not in the band.
TEST_F(Grid, DistancesAreALevelSetWhereTheyHaveTwoSides) {
  Brick brick{{0, 0, -1}, {}};
  std::vector<float> values;
  for (const auto& [x, y, z] : std::vector<Vec3i>{{2, 3, 4}, {3, 2, 4}, {3, 3, 3}, {3, 3, 5}, {3, 4, 4}, {4, 3, 4}}) {
    brick.mask[static_cast<size_t>(x)] |= uint64_t{1} << (y << 3 | z);
    values.push_back(-0.125F - 0.015625F * static_cast<float>(values.size()));
  }
  Certificate certificate;
  certificate.band = BandFacts{0.25};
  certificate.fields = {{Field::kDistance, "0123"}};
  certificate.signed_distance = true;
  const std::vector<FieldValues> fields{ValuesOf<float>(Field::kDistance, values)};
  for (const auto& [width, whole] : {std::pair{0.25, true}, {0.25, false}, {0.2, true}}) {
    DistanceGrid grid(kCubes, width, /*is_signed=*/true, whole);
    ASSERT_TRUE(grid.Add({{&brick, 1}, 1, fields}).ok());
    grid.SetCertificate(certificate);
    ASSERT_TRUE(grid.Write(Path("d.vdb")).ok());
    openvdb::io::File file(Path("d.vdb"));
    file.open();
    const auto read = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("distance"));
    const bool level_set = whole && width == 0.25;
    EXPECT_EQ(read->getGridClass(), level_set ? openvdb::GRID_LEVEL_SET : openvdb::GRID_UNKNOWN);
    EXPECT_EQ(read->background(), static_cast<float>(width));
    EXPECT_EQ(read->activeVoxelCount(), 6u);
    EXPECT_EQ(read->tree().getValue({2, 3, -4}), -0.125F);
    EXPECT_EQ(read->tree().getValue({4, 3, -4}), -0.203125F);
    EXPECT_EQ(read->tree().getValue({3, 3, -4}), static_cast<float>(level_set ? -width : width));
    EXPECT_EQ(read->getMetadata<openvdb::DoubleMetadata>("latvox_band_width")->value(), 0.25);
    EXPECT_EQ(read->getMetadata<openvdb::StringMetadata>("latvox_distance_digest")->value(), "0123");
    EXPECT_TRUE(read->getMetadata<openvdb::BoolMetadata>("latvox_signed_distance")->value());
    EXPECT_TRUE(read->transform().indexToWorld(openvdb::Vec3d(4, 0, 4)).eq(openvdb::Vec3d(0, 0, 2)));
  }
}

TEST_F(Grid, FieldsAreGridsOfTheSameVoxels) {
  const Brick brick{{0, 0, -1}, {0, 0, uint64_t{5} << 28, 0, uint64_t{7} << 28}};  // (2, 3, -4) and on
  const std::vector<FieldValues> fields{
      ValuesOf<uint32_t>(Field::kPart, {7, 0, 0x7FFFFFFF, 1, 3}),
      ValuesOf<uint8_t>(Field::kColor, {255, 128, 1, 0, 1, 0, 0, 0, 0, 0, 0, 2, 0, 0, 4})};
  FieldGrids grids(kBcc, {Field::kPart, Field::kColor});
  ASSERT_TRUE(grids.Add({{&brick, 1}, 1, fields}).ok());
  Certificate certificate;
  certificate.fields = {{Field::kPart, "0123"}, {Field::kColor, "4567"}};
  grids.SetCertificate(certificate);
  ASSERT_TRUE(grids.Write(Path("a.vdb")).ok());
  openvdb::io::File file(Path("a.vdb"));
  file.open();
  const auto voxels = openvdb::gridPtrCast<openvdb::BoolGrid>(file.readGrid("voxels"));
  const auto parts = openvdb::gridPtrCast<openvdb::Int32Grid>(file.readGrid("part"));
  const auto colors = openvdb::gridPtrCast<openvdb::Vec3SGrid>(file.readGrid("color"));
  ASSERT_TRUE(voxels && parts && colors);
  EXPECT_TRUE(parts->tree().hasSameTopology(colors->tree()));
  EXPECT_EQ(voxels->activeVoxelCount(), 5u);
  EXPECT_EQ(parts->activeVoxelCount(), 5u);
  EXPECT_EQ(parts->transform(), voxels->transform());
  EXPECT_EQ(colors->transform(), voxels->transform());
  EXPECT_EQ(parts->tree().getValue({2, 3, -4}), 7);
  EXPECT_EQ(parts->tree().getValue({2, 3, -2}), 0);
  EXPECT_EQ(parts->tree().getValue({4, 3, -4}), 0x7FFFFFFF);
  EXPECT_EQ(parts->tree().getValue({4, 3, -2}), 3);
  EXPECT_EQ(parts->tree().getValue({2, 3, -3}), -1);
  EXPECT_EQ(colors->tree().getValue({2, 3, -4}), openvdb::Vec3s(1, 128.0F / 255, 1.0F / 255));
  EXPECT_EQ(colors->tree().getValue({2, 3, -2}), openvdb::Vec3s(0, 1.0F / 255, 0));
  EXPECT_EQ(colors->tree().getValue({2, 3, -3}), openvdb::Vec3s(0, 0, 0));
  for (const openvdb::GridBase::Ptr& grid : openvdb::GridPtrVec{voxels, parts, colors}) {
    EXPECT_EQ(grid->getMetadata<openvdb::StringMetadata>("latvox_fields")->value(), "part,color");
    EXPECT_EQ(grid->getMetadata<openvdb::StringMetadata>("latvox_part_digest")->value(), "0123");
    EXPECT_EQ(grid->getMetadata<openvdb::StringMetadata>("latvox_color_digest")->value(), "4567");
  }
}

TEST_F(Grid, EveryFieldIsReadBackAsItWasWritten) {
  const Brick brick{{0, 0, -1}, {3}};
  std::vector<FieldValues> fields;
  std::vector<Field> names;
  const std::vector<uint32_t> kLabels = {300, 7};
  const std::vector<Vec3i> kNeighbors = {{-1, 0, 2}, {0, 0, -1}, {0, 0, 1}, {1, 0, -2}};
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  for (const FieldFacts& row : kFields) {
    names.push_back(row.field);
    if (row.field == Field::kLinks) {
      fields.push_back(ValuesOf<float>(row.field, {0.25F, kNone, 1, kNone, kNone, kNone, 0x1p-126F, kNone}));
    } else if (row.field == Field::kLinkTriangles) {
      fields.push_back(ValuesOf<uint32_t>(row.field, {0, ~0U, 0x7FFFFFFF, ~0U, ~0U, ~0U, 5, ~0U}));
    } else if (row.field == Field::kLinkCrossings) {
      fields.push_back(ValuesOf<uint32_t>(row.field, {1, 0, 3, 0, 0, 0, 2, 0}));
    } else if (row.type == NumberType::kFloat32) {
      fields.push_back(ValuesOf<float>(row.field, {0.25F, -0.5F, 0.125F, 1, 0, 0.75F}));
    } else if (row.type == NumberType::kUint32) {
      fields.push_back(ValuesOf<uint32_t>(row.field, {9, 0x7FFFFFFF, 0, 0, 0, 0}));
    } else if (row.type == NumberType::kUint16) {
      fields.push_back(ValuesOf<uint16_t>(row.field, {4096, 511, 0, 3}));
    } else {
      fields.push_back(ValuesOf<uint8_t>(row.field, {0, 7, 255, 254, 1, 128}));
    }
    if (row.is_of_labels()) fields.back().labels = kLabels;
    if (row.is_of_links()) fields.back().neighbors = kNeighbors.size();
    fields.back().bytes.resize(2 * fields.back().bytes_of_voxel());
  }
  FieldGrids grids(kSkew, names, kLabels, kNeighbors);
  Certificate certificate;
  certificate.fields = {{Field::kLabelFractions, ""}};
  certificate.fraction_labels = kLabels;
  grids.SetCertificate(certificate);
  ASSERT_TRUE(grids.Add({{&brick, 1}, 1, fields}).ok());
  ASSERT_TRUE(grids.Write(Path("f.vdb")).ok());
  ASSERT_TRUE(grids.WriteNano(Path("f.nvdb")).ok());
  for (const char* name : {"f.vdb", "f.nvdb"}) {
    const auto content = ReadGridContent(Path(name));
    ASSERT_TRUE(content.ok()) << content.status();
    EXPECT_EQ(content->fields, fields);
    EXPECT_EQ(content->neighbors, kNeighbors);
    EXPECT_EQ(content->distances, (DistanceRange{0.5, true}));
    EXPECT_EQ(content->file.info.transform.basis, kSkew.basis);
    EXPECT_EQ(content->file.info.transform.origin, kSkew.origin);
    EXPECT_FALSE(content->is_band);
  }
}

// The bytes have the types, too.
TEST_F(Grid, MetadataThatWereReadAreWrittenWithTheirTypes) {
  const Brick brick{{0, 0, -1}, {3}};
  const std::vector<FieldValues> fields{ValuesOf<float>(Field::kDistance, {0.25F, -0.125F})};
  Certificate certificate;
  certificate.separability = 2;
  certificate.minimal = true;
  certificate.snap_error_max = 0.1;
  certificate.lattice = "1";  // a text, in spite of its looks
  certificate.solid = SolidFacts{"parity", 5'000'000'000};
  certificate.walk.emplace().cavities = 3;
  certificate.band = BandFacts{0.25};
  certificate.fields = {{Field::kDistance, "0123"}};
  MeshNote note;
  note.alpha_cutoff = 0.5;
  note.facts.emplace().triangles = 12;
  FieldGrids grids(kSkew, {Field::kDistance});
  ASSERT_TRUE(grids.Add({{&brick, 1}, 1, fields}).ok());
  grids.SetRequest({}, note);
  grids.SetCertificate(certificate);
  ASSERT_TRUE(grids.Write(Path("a.vdb")).ok());
  ASSERT_TRUE(grids.WriteNano(Path("a.nvdb")).ok());
  for (const char* name : {"a.vdb", "a.nvdb"}) {
    const auto content = ReadGridContent(Path(name));
    ASSERT_TRUE(content.ok()) << content.status();
    FieldGrids again(content->file.info.transform, {Field::kDistance});
    ASSERT_TRUE(again.Add(content->Batch()).ok());
    again.SetMetadata(content->file.info.metadata);
    ASSERT_TRUE(again.Write(Path("b.vdb")).ok());
    ASSERT_TRUE(again.WriteNano(Path("b.nvdb")).ok());
    EXPECT_EQ(Read("b.vdb"), Read("a.vdb")) << name;
    EXPECT_EQ(Read("b.nvdb"), Read("a.nvdb")) << name;
  }
}

TEST_F(Grid, MetadataThatAreNoValuesOfTheirTypeStayTexts) {
  VoxelGrid grid(kBcc);
  grid.SetMetadata({{"latvox_minimal", "perhaps"}, {"latvox_other", "1"}, {"name", "mine"}});
  EXPECT_EQ(grid.content().grid->getMetadata<openvdb::StringMetadata>("latvox_minimal")->value(), "perhaps");
  EXPECT_EQ(grid.content().grid->getMetadata<openvdb::StringMetadata>("latvox_other")->value(), "1");
  EXPECT_EQ(grid.content().grid->getName(), "voxels");
}

TEST_F(Grid, AGridWithoutACertificateHasNoDigest) {
  ASSERT_TRUE(VoxelGrid(kBcc).Write(Path("g.vdb")).ok());
  const auto digest = ReadGridFileDigest(Path("g.vdb"));
  ASSERT_TRUE(digest.ok()) << digest.status();
  EXPECT_EQ(*digest, "");
}

TEST_F(Grid, AFileThatIsNoGridFileIsAnErrorThatNamesIt) {
  EXPECT_EQ(ReadGridFileInfo(Path("none.vdb")).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(ReadGridFileDigest(Path("none.vdb")).status().code(), absl::StatusCode::kNotFound);
  for (const std::string& bytes : {std::string(), std::string("this is no grid"), std::string(1000, '\0')}) {
    const auto info = ReadGridFileInfo(Write("bad.vdb", bytes));
    EXPECT_EQ(info.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(info.status().message()), HasSubstr("bad.vdb"));
    EXPECT_EQ(ReadGridFileDigest(Path("bad.vdb")).status().code(), absl::StatusCode::kInvalidArgument);
  }
  ASSERT_TRUE(VoxelGrid(kBcc).WriteNano(Path("whole.nvdb")).ok());
  const std::string whole = Read("whole.nvdb");
  for (const size_t bytes : {size_t{8}, size_t{100}, whole.size() / 2, whole.size() - 1}) {
    const auto content = ReadGridContent(Write("bad.nvdb", whole.substr(0, bytes)));
    EXPECT_EQ(content.status().code(), absl::StatusCode::kInvalidArgument) << bytes;
    EXPECT_THAT(std::string(content.status().message()), HasSubstr("bad.nvdb")) << bytes;
  }
}

TEST_F(Grid, WritingToNowhereIsAnErrorThatNamesThePath) {
  const absl::Status status = VoxelGrid(kBcc).Write(Path("missing/g.vdb"));
  EXPECT_THAT(std::string(status.message()), HasSubstr("missing/g.vdb"));
}

TEST_F(Grid, AFullDiskIsAnErrorThatNamesThePath) {
  const absl::Status status = VoxelGrid(kBcc).Write("/dev/full");
  EXPECT_EQ(status.code(), absl::StatusCode::kUnknown);
  EXPECT_THAT(std::string(status.message()), testing::AllOf(HasSubstr("/dev/full"), HasSubstr("No space left")));
}

// Both sides of the limit, for a scale, which OpenVDB checks itself, and for other matrices.
TEST_F(Grid, VoxelsTooSmallForATransformAreAnErrorAndOthersAreWritten) {
  for (const GridTransform& unit : {kBcc, kSkew, kCubes}) {
    for (const double size : {1.43e-5, 1.45e-5, 1e-7, 1e-3}) {
      GridTransform transform = unit;
      const auto& [a, b, c] = unit.basis;
      const double volume = std::abs(openvdb::Mat3d(a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]).det());
      for (Vec3d* step : {&transform.basis.a, &transform.basis.b, &transform.basis.c}) {
        for (double& x : *step) x *= size / std::cbrt(volume);
      }
      transform.voxel_size = size;
      const absl::Status status = CheckGridTransform(transform);
      ASSERT_EQ(status.ok(), size > 1.44225e-5) << size << ": " << status;
      if (status.ok()) {
        ASSERT_TRUE(VoxelGrid(transform).Write(Path("g.vdb")).ok());
        const auto info = ReadGridFileInfo(Path("g.vdb"));
        ASSERT_TRUE(info.ok()) << info.status();
        EXPECT_EQ(info->transform.basis, transform.basis);
        EXPECT_EQ(info->transform.origin, transform.origin);
      } else {
        EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
        EXPECT_EQ(GetErrorDetails(status).field, "voxel_size");
        EXPECT_EQ(GetErrorDetails(status).limit, "1.44225e-05");
        EXPECT_THAT(std::string(status.message()), HasSubstr("1.44225e-05"));
      }
    }
  }
}

}  // namespace
}  // namespace latvox::client
