// Images in space and files of VTK, byte by byte.
#include <gmock/gmock.h>
#include <zlib.h>

#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "client/tool/output/box_output.h"
#include "client/tool/output/box_shape.h"
#include "client/tool/output/image_header.h"
#include "client/tool/output/output.h"
#include "tests/unit/client/fields.h"
#include "tests/unit/client/files.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

template <class T>
T At(const std::string& bytes, size_t at) {
  T value;
  std::memcpy(&value, &bytes.at(at), sizeof(T));
  return value;
}

// The box 2 x 3 x 2 from (-1, 0, 7) on, in four bricks; its voxels are (-1, 0, 7), (-1, 2, 8), (0, 0, 7).
class Image : public FilesTest {
 protected:
  static Accepted MakeAccepted() {
    Accepted accepted;
    accepted.grid = {{{0.5, 0, 0}, {0, 0.5, 0}, {0.25, 0.25, 0.25}}, {1, 2, 3}, 0.4};
    accepted.index_box = IndexBox{{-1, 0, 7}, {1, 3, 9}};
    return accepted;
  }

  static std::vector<Brick> MakeBricks() {
    Brick a{{-1, 0, 0}, {}}, b{{-1, 0, 1}, {}}, c{{0, 0, 0}, {}};
    a.mask[7] = uint64_t{1} << 7;
    b.mask[7] = uint64_t{1} << (2 << 3);
    c.mask[0] = uint64_t{1} << 7;
    return {a, b, c};
  }

  absl::Status Fill(const std::string& name, const VoxelizeRequest& request, const std::vector<FieldValues>& fields,
                    const Accepted& accepted, const OutputOptions& options = {}) const {
    auto output = OpenOutput(Path(name), request, options);
    if (!output.ok()) return output.status();
    const std::vector<Brick> bricks = MakeBricks();
    if (auto status = (*output)->Begin(accepted); !status.ok()) return status;
    if (auto status = (*output)->Add({bricks, 1, fields}); !status.ok()) return status;
    if (auto status = (*output)->Finish({}); !status.ok()) return status;
    return (*output)->Commit();
  }

  std::string Mask(const std::string& name, const OutputOptions& options = {}) const {
    EXPECT_EQ(Fill(name, {}, {}, MakeAccepted(), options), absl::OkStatus());
    return Read(name);
  }
};

// i runs fastest, then j, then k.
const std::string kMask(
    "\1\1\0\0\0\0"
    "\0\0\0\0\1\0",
    12);

TEST_F(Image, NrrdNamesTheBasisAndIsCompressed) {
  const std::string file = Mask("o.nrrd"), header =
                                               "NRRD0005\ncontent: data\ntype: uint8\ndimension: 3\n"
                                               "space: left-posterior-superior\nsizes: 2 3 2\n"
                                               "space directions: (0.5,0,0) (0,0.5,0) (0.25,0.25,0.25)\n"
                                               "kinds: domain domain domain\nendian: little\nencoding: gzip\n"
                                               "space origin: (2.25,3.75,4.75)\n\n";
  ASSERT_THAT(file, StartsWith(header));
  EXPECT_EQ(file.substr(header.size(), 3), "\x1f\x8b\x08");
}

TEST_F(Image, MetaImageTellsTheBytesOfItsStream) {
  const std::string file = Mask("o.mha");
  EXPECT_THAT(file, HasSubstr("\nOffset = 2.25 3.75 4.75\n"));
  EXPECT_THAT(file, HasSubstr("\nTransformMatrix = 1 0 0 0 1 0 0.57735"));
  EXPECT_THAT(file, HasSubstr("\nElementSpacing = 0.5 0.5 0.4330127"));
  EXPECT_THAT(file, HasSubstr("\nDimSize = 2 3 2\nElementNumberOfChannels = 1\nElementType = MET_UCHAR\n"));
  const std::string last = "ElementDataFile = LOCAL\n", size = "CompressedDataSize = ";
  const std::string stream = file.substr(file.find(last) + last.size());
  EXPECT_EQ(std::stoul(file.substr(file.find(size) + size.size(), 20)), stream.size());
  std::string data(12, 'x');
  uLongf bytes = data.size();
  ASSERT_EQ(uncompress(reinterpret_cast<Bytef*>(data.data()), &bytes, reinterpret_cast<const Bytef*>(stream.data()),
                       stream.size()),
            Z_OK);
  EXPECT_EQ(data, kMask);
}

TEST_F(Image, AMetaPairIsAHeaderAndItsData) {
  EXPECT_THAT(Mask("o.mhd"), HasSubstr("\nElementType = MET_UCHAR\nElementDataFile = o.raw\n"));
  EXPECT_EQ(Read("o.raw"), kMask);
  std::filesystem::create_directory(Path("p.raw"));
  EXPECT_THAT(std::string(Fill("p.mhd", {}, {}, MakeAccepted()).message()), HasSubstr("p.raw: "));
  EXPECT_FALSE(std::filesystem::exists(Path("p.mhd")));
  EXPECT_EQ(Fill("a\nb.mhd", {}, {}, MakeAccepted()).code(), absl::StatusCode::kInvalidArgument);
}

TEST_F(Image, NiftiHasTheBasisAsSform) {
  const std::string file = Mask("o.nii");
  EXPECT_EQ(At<int32_t>(file, 0), 348);
  EXPECT_THAT((At<std::array<int16_t, 8>>(file, 40)), ElementsAre(3, 2, 3, 2, 1, 1, 1, 1));
  EXPECT_EQ(At<int16_t>(file, 70), 2);
  EXPECT_EQ(At<float>(file, 108), 352);
  EXPECT_EQ(At<int16_t>(file, 252), 0);
  EXPECT_EQ(At<int16_t>(file, 254), 2);
  EXPECT_THAT((At<std::array<float, 4>>(file, 280)), ElementsAre(0.5F, 0, 0.25F, 2.25F));
  EXPECT_THAT((At<std::array<float, 4>>(file, 312)), ElementsAre(0, 0, 0.25F, 4.75F));
  EXPECT_STREQ(&file[344], "n+1");
  EXPECT_EQ(file.substr(352), kMask);
}

TEST_F(Image, ComponentsOfNiftiComeOneAfterAnother) {
  VoxelizeRequest request;
  request.fields = {Field::kPoint};
  const std::vector<FieldValues> fields = {ValuesOf<float>(Field::kPoint, {1, 2, 3, 4, 5, 6})};
  ASSERT_EQ(Fill("o.nii", request, fields, MakeAccepted()), absl::OkStatus());
  const std::string file = Read("o.nii");
  EXPECT_THAT((At<std::array<int16_t, 8>>(file, 40)), ElementsAre(5, 2, 3, 2, 1, 2, 1, 1));
  EXPECT_EQ(At<int16_t>(file, 68), 1007);
  ASSERT_EQ(file.size(), 352U + 2 * 12 * 4);
  for (size_t component = 0; component < 2; ++component) {
    const auto values = At<std::array<float, 12>>(file, 352 + 48 * component);
    const auto shift = static_cast<float>(component);
    EXPECT_EQ(values[0], 1 + shift);   // (-1, 0, 7), the first voxel
    EXPECT_EQ(values[1], 5 + shift);   // (0, 0, 7), the third
    EXPECT_EQ(values[10], 3 + shift);  // (-1, 2, 8), the second
    EXPECT_TRUE(std::isnan(values[2]));
  }
}

TEST_F(Image, FieldsOfOneTypeAreComponentsOfEachElement) {
  VoxelizeRequest request;
  request.fields = {Field::kTriangle, Field::kPart};
  const std::vector<FieldValues> fields = {ValuesOf<uint32_t>(Field::kTriangle, {10, 20, 30}),
                                           ValuesOf<uint32_t>(Field::kPart, {0, 1, 2})};
  ASSERT_EQ(Fill("o.mhd", request, fields, MakeAccepted()), absl::OkStatus());
  EXPECT_THAT(Read("o.mhd"), HasSubstr("\nElementNumberOfChannels = 2\nElementType = MET_INT\n"));
  const std::string data = Read("o.raw");
  ASSERT_EQ(data.size(), 12 * 2 * sizeof(int32_t));
  using Element = std::array<int32_t, 2>;
  EXPECT_THAT(At<Element>(data, 0), ElementsAre(11, 1));       // (-1, 0, 7), the first voxel; labels begin with 1
  EXPECT_THAT(At<Element>(data, 8), ElementsAre(31, 3));       // (0, 0, 7), the third
  EXPECT_THAT(At<Element>(data, 10 * 8), ElementsAre(21, 2));  // (-1, 2, 8), the second
  EXPECT_THAT(At<Element>(data, 2 * 8), ElementsAre(0, 0));
  ASSERT_EQ(Fill("o.nrrd", request, fields, MakeAccepted()), absl::OkStatus());
  EXPECT_THAT(Read("o.nrrd"), HasSubstr("\nsizes: 2 2 3 2\n"));
  EXPECT_THAT(Read("o.nrrd"), HasSubstr("\nkinds: list domain domain domain\n"));
  EXPECT_THAT(Read("o.nrrd"), HasSubstr("\ncontent: triangle,part\n"));
}

TEST_F(Image, AnArrayHasTheFieldsThatTheOptionsSelect) {
  VoxelizeRequest request;
  request.fields = {Field::kDistance, Field::kPart};
  const std::vector<FieldValues> fields = {ValuesOf<float>(Field::kDistance, {1, 2, 3}),
                                           ValuesOf<uint32_t>(Field::kPart, {0, 1, 2})};
  ASSERT_EQ(Fill("o.nii", request, fields, MakeAccepted(), {.array = std::vector{Field::kPart}}), absl::OkStatus());
  EXPECT_EQ(At<int32_t>(Read("o.nii"), 352 + 10 * sizeof(int32_t)), 2);  // (-1, 2, 8), the second voxel
  ASSERT_EQ(Fill("o.npy", request, fields, MakeAccepted(), {.dense_npy = true, .array = std::vector{Field::kDistance}}),
            absl::OkStatus());
  EXPECT_THAT(Read("o.npy"), HasSubstr("'descr': '<f4'"));
  ASSERT_EQ(Fill("p.nii", request, fields, MakeAccepted(), {.array = std::vector<Field>()}), absl::OkStatus());
  EXPECT_EQ(Read("p.nii").substr(352), kMask);
  ASSERT_EQ(Fill("o.csv", request, fields, MakeAccepted(), {.array = std::vector<Field>()}), absl::OkStatus());
  EXPECT_THAT(Read("o.csv"), HasSubstr("i,j,k,x,y,z,distance,part\n"));
}

TEST_F(Image, FieldsOfTwoTypesAndTooManyBytesAreRefused) {
  VoxelizeRequest request;
  request.fields = {Field::kPart, Field::kDistance};
  const std::string refusal(Fill("o.nrrd", request, {}, MakeAccepted()).message());
  EXPECT_THAT(refusal, HasSubstr(".npz"));
  EXPECT_THAT(refusal, testing::Not(HasSubstr(".mha")));
  Accepted accepted = MakeAccepted();
  accepted.index_box = IndexBox{{0, 0, 0}, {1024, 512, 512}};  // 4 GiB: 16 bytes for each
  for (const auto& [fields, fits] : {std::pair(std::vector{Field::kDistance, Field::kNormal}, true),
                                     {std::vector{Field::kDistance, Field::kNormal, Field::kPoint}, false}}) {
    request.fields = fields;
    const auto output = OpenOutput(Path("o.nrrd"), request);
    ASSERT_TRUE(output.ok());
    EXPECT_EQ((*output)->Begin(accepted).code(), fits ? absl::StatusCode::kOk : absl::StatusCode::kResourceExhausted);
  }
}

TEST_F(Image, ABinvoxRefusesALongBoxWithItsFirstVoxelBeyond) {
  Accepted accepted = MakeAccepted();
  accepted.grid = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}, 1};
  const auto output = OpenOutput(Path("o.binvox"), {});
  ASSERT_TRUE(output.ok() && (*output)->Begin(accepted).ok());
  std::vector<Brick> brick(1, Brick{{0, 0, 0}, {}});
  brick[0].mask[0] = 1;
  for (const auto& [place, code] : {std::pair(0, absl::StatusCode::kOk),
                                    {4088, absl::StatusCode::kOk},
                                    {4096, absl::StatusCode::kResourceExhausted}}) {
    brick[0].brick_ijk = {0, place / 8, 0};
    const absl::Status status = (*output)->Add({brick, 1, {}});
    EXPECT_EQ(status.code(), code) << status;
  }
}

TEST_F(Image, ASideBeyondNifti1MakesNifti2) {
  for (const auto& [side, bytes] : {std::pair(32767, 352), {32768, 544}}) {
    const std::string file = Mask("o.nii", {.shape = {.dims = Vec3i{2, side, 2}}});
    EXPECT_EQ(file.size(), static_cast<size_t>(bytes + 4 * side));
    int32_t header = 0;
    std::memcpy(&header, file.data(), sizeof(header));
    EXPECT_EQ(header, bytes - 4);
  }
}

TEST_F(Image, WithoutAVoxelThereIsOneEmptyElement) {
  for (const bool has_box : {true, false}) {  // of the call
    Accepted accepted = MakeAccepted();
    if (!has_box) accepted.index_box.reset();
    const auto output = OpenOutput(Path("o.nii"), {});
    ASSERT_TRUE(output.ok() && (*output)->Begin(accepted).ok() && (*output)->Finish({}).ok());
    ASSERT_EQ((*output)->Commit(), absl::OkStatus());
    EXPECT_EQ(Read("o.nii").substr(352), std::string(1, '\0'));
  }
}

TEST_F(Image, CoversTheVoxelsAloneWhateverBoundsThem) {
  Accepted wide = MakeAccepted();
  wide.index_box = IndexBox{{-3, -4, 5}, {6, 7, 11}};
  for (const auto& [name, pad] : {std::pair("o.nrrd", 0U), {"o.nii", 1U}, {"o.npy", 1U}, {"o.npz", 0U}}) {
    const OutputOptions options = {.dense_npy = true, .shape = {.pad = pad}};
    const std::string tight = Mask(name, options);
    ASSERT_EQ(Fill(name, {}, {}, wide, options), absl::OkStatus());
    EXPECT_EQ(Read(name), tight) << name;
  }
}

TEST_F(Image, AShapePutsTheBoxInTheMiddle) {
  const OutputOptions options = {.dense_npy = true, .shape = {.pad = 1, .dims = Vec3i{4, 6, 6}}};
  const std::string nifti = Mask("o.nii", options);
  EXPECT_THAT((At<std::array<int16_t, 8>>(nifti, 40)), ElementsAre(3, 4, 6, 6, 1, 1, 1, 1));
  EXPECT_THAT((At<std::array<float, 4>>(nifti, 312)), ElementsAre(0, 0, 0.25F, 4.25F));  // k begins with 5
  EXPECT_EQ(nifti[352 + (2 * 6 + 1) * 4 + 1], 1);                                        // (-1, 0, 7)
  EXPECT_THAT(Mask("o.npy", options), HasSubstr("'shape': (4, 6, 6)"));
  const auto box = ShapedBox({{0, 0, 0}, {3, 3, 3}}, {.dims = Vec3i{4, 3, 8}}, "x");
  ASSERT_TRUE(box.ok());
  EXPECT_EQ(*box, (IndexBox{{0, 0, -2}, {4, 3, 6}}));
  EXPECT_THAT(
      std::string(Fill("p.nrrd", {}, {}, MakeAccepted(), {.shape = {.pad = 1, .dims = Vec3i{3, 6, 6}}}).message()),
      HasSubstr("p.nrrd: --dims: 3 along i is less than the 4 points that the voxels take with their padding"));
}

TEST_F(Image, VtiIsOfCellsAroundThePositions) {
  Accepted accepted = MakeAccepted();
  EXPECT_EQ(Fill("o.vti", {}, {}, accepted).code(), absl::StatusCode::kInvalidArgument);
  accepted.grid.basis = {{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 2}};
  ASSERT_EQ(Fill("o.vti", {}, {}, accepted), absl::OkStatus());
  const std::string file = Read("o.vti");
  EXPECT_THAT(file, HasSubstr("<ImageData WholeExtent=\"0 2 0 3 0 2\" Origin=\"0.25 1.75 16\" Spacing=\"0.5 0.5 2\">"));
  const size_t data = file.find("\n_") + 2;
  EXPECT_THAT((At<std::array<uint64_t, 3>>(file, data)), ElementsAre(1, 1 << 20, 12));
  const auto packed = At<uint64_t>(file, data + 24);
  EXPECT_EQ(file.substr(data + 32 + packed), "\n</AppendedData>\n</VTKFile>\n");
}

TEST(Boxes, StretchedCubesAreBoxesAndOthersAreNot) {
  EXPECT_TRUE(IsAlongAxes({{1, 0, 0}, {0, 2, 0}, {0, 0, 3}}));
  EXPECT_FALSE(IsCubic({{1, 0, 0}, {0, 2, 0}, {0, 0, 1}}));
  EXPECT_TRUE(IsCubic({{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}));
  EXPECT_FALSE(IsAlongAxes({{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_FALSE(IsAlongAxes({{0, 1, 0}, {1, 0, 0}, {0, 0, 1}}));
}

}  // namespace
}  // namespace latvox::client
