// 3MF whose broken elements are left out. tests/e2e/three_mf_test.py has the others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>

#include "absl/strings/escaping.h"
#include "client/mesh_files/three_mf_file.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

// Four vertices; vertex 2 has x="nan". Triangles 0 1 3, 0 1 2 and 0 1 9.
constexpr absl::string_view kArchive =
    "UEsDBBQAAAAIAE0se116D9zZbgAAAI0AAAALAAAAX3JlbHMvLnJlbHOzCUrNSSzJzM8rzsgsKLazQeYqhCQWpaeW2CrpG7voG6fk"
    "5qek5uiBSSWFkMqCVFuljJKSAit9/eLkjNTcxGK93Mzkovzi/LQSveT8XJCOxLzStMTkktKizLx0fSMDQ2N9A0OYSUr6djb6qLYD"
    "AFBLAwQUAAAACABNLHtdezZDrJEAAABoAQAAEAAAADNELzNkbW9kZWwubW9kZWyFkFsKwyAQRbcibsCafBVG95LEobH4ADWSZvWt"
    "Gqg/aX+GC2dmLhywXqGREDD6LSwYJfj5iUsiWgnKqQSLcZWQMSRdcUm4k13QGyWvOo8yWY/4NXKTu4b9S14Q+xanoCf3MH0kmdft"
    "PNTKPAo6lqsffPjD77W162JNAGtaPqFTNW/aKAk6oSWNN2vlxclYE/wGUEsBAhQDFAAAAAgATSx7XXoP3NluAAAAjQAAAAsAAAAA"
    "AAAAAAAAAIABAAAAAF9yZWxzLy5yZWxzUEsBAhQDFAAAAAgATSx7XXs2Q6yRAAAAaAEAABAAAAAAAAAAAAAAAIABlwAAADNELzNk"
    "bW9kZWwubW9kZWxQSwUGAAAAAAIAAgB3AAAAVgEAAAAA";

TEST(ThreeMfFile, BrokenElementsAreLeftOutIfAsked) {
  std::string bytes;
  ASSERT_TRUE(absl::Base64Unescape(kArchive, &bytes));
  EXPECT_THAT(std::string(Parse3mf(bytes).status().message()),
              HasSubstr("x=\"nan\" of vertex 2 is not a finite number"));
  const Mesh mesh = Parse3mf(bytes, {.skip_bad = true}).value();
  EXPECT_THAT(mesh.triangles, ElementsAre(std::array<uint32_t, 3>{0, 1, 2}));
  ASSERT_EQ(mesh.positions.size(), 3);
  EXPECT_THAT(mesh.positions[2], ElementsAre(0, 0, 1));
  ASSERT_EQ(mesh.warnings.size(), 1);
  EXPECT_EQ(mesh.warnings[0].code, "BAD_ELEMENTS");
  EXPECT_THAT(mesh.warnings[0].message, HasSubstr("3 broken elements are left out; the first: 3D/3dmodel.model"));
}

}  // namespace
}  // namespace latvox::client
