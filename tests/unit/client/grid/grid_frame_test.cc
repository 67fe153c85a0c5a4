#include "client/grid/grid_frame.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <string>

#include "latvox/grid/field_grids.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {
namespace {

using testing::HasSubstr;

// A file of two grids.
std::string Whole() {
  const std::string path = testing::TempDir() + "/frame.vdb";
  const GridTransform cubes = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {0, 0, 0}, 1};
  FieldGrids grids(cubes, {Field::kPart});
  Certificate certificate;
  certificate.digest = "0123456789abcdef0123456789abcdef";
  grids.SetCertificate(certificate);
  EXPECT_TRUE(grids.Write(path).ok());
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), {}};
  std::filesystem::remove(path);
  return bytes;
}

GridFrame Read(const std::string& bytes) {
  std::istringstream in(bytes);
  return ReadGridFrame(in, bytes.size());
}

std::string Refusal(const std::string& bytes) {
  try {
    Read(bytes);
    return "none";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

std::string With(std::string bytes, const std::string& old, const std::string& now) {
  return bytes.replace(bytes.find(old), now.size(), now);
}

TEST(GridFrame, TellsNamesTypesAndMetadata) {
  const GridFrame frame = Read(Whole());
  ASSERT_EQ(frame.grids.size(), 2u);
  EXPECT_EQ(frame.grids[1].name, "part");
  EXPECT_EQ(frame.grids[1].type, "Tree_int32_5_4_3");
  EXPECT_EQ(frame.grids[0].name, "voxels");
  EXPECT_EQ(frame.grids[0].transform, "UniformScaleMap");
  int digests = 0;
  for (const FrameMetadata& metadata : frame.grids[0].metadata) {
    if (metadata.name != "latvox_digest") continue;
    EXPECT_EQ(metadata.type, "string");
    EXPECT_EQ(metadata.value, "0123456789abcdef0123456789abcdef");
    ++digests;
  }
  EXPECT_EQ(digests, 1);
}

TEST(GridFrame, SaysWhatIsWrong) {
  const std::string whole = Whole();
  EXPECT_THAT(Refusal("this is no grid"), HasSubstr("does not begin like one"));
  EXPECT_THAT(Refusal(With(whole, std::string("\xe0\0\0\0", 4), "\xdf")), HasSubstr("its format is 223, not 224"));
  EXPECT_THAT(Refusal(With(whole, "Tree_int32_5_4_3", "Tree_int32_5_4_3")), "none");
  EXPECT_THAT(Refusal(With(whole, std::string("\x05\0\0\0vec3i\x0c", 10), std::string("\x05\0\0\0vec3i\x0d", 10))),
              HasSubstr("have 13 bytes, not 12"));
  EXPECT_THAT(Refusal(With(whole, "vec3i", "vec9i")), HasSubstr("are of the type vec9i"));
  EXPECT_THAT(Refusal(With(whole, std::string("\x04\0\0\0bool\x01\0\0\0", 12),
                           std::string("\x04\0\0\0bool\x01\0\0\0\x02", 13))),
              HasSubstr("neither true nor false"));
}

TEST(GridFrame, NoGridsShareMetadata) {
  std::string bytes = Whole();
  const size_t places = bytes.find("Tree_bool_5_4_3") + 15 + 4;  // of the grid, its blocks and its end
  bytes.replace(places + 8, 8, bytes, places, 8);
  EXPECT_THAT(Refusal(bytes), HasSubstr("the metadata of its grid reach into the tree"));
}

TEST(GridFrame, AnEndAnywhereIsAnError) {
  const std::string whole = Whole();
  for (size_t length = 0; length < whole.size(); length += length < 4000 ? 1 : 101) {
    EXPECT_NE(Refusal(whole.substr(0, length)), "none") << length;
  }
}

// Lengths of gigabytes, too, end in an error or a frame: the test would otherwise end for lack of memory, or time.
TEST(GridFrame, NoNumberIsTrusted) {
  const std::string whole = Whole();
  for (size_t at = 0; at + 8 <= whole.size() && at < 4000; ++at) {
    for (const char byte : {'\0', '\x7f', '\xff'}) {
      for (const size_t width : {1, 4, 8}) Refusal(std::string(whole).replace(at, width, width, byte));
    }
  }
}

}  // namespace
}  // namespace latvox::client
