// Files that other programs write, in ways that their formats do not quite allow.
#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/str_replace.h"
#include "client/mesh_files/decode.h"
#include "client/mesh_files/mesh_file.h"
#include "client/mesh_files/obj_file.h"
#include "client/mesh_files/ply_file.h"
#include "client/mesh_files/stl_file.h"
#include "tests/unit/client/files.h"

namespace latvox::client {
namespace {

using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr char kObj[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
constexpr char kPlyHead[] =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n";
constexpr char kFacet[] =
    "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";

// Returns the codes of the warnings.
std::vector<std::string> Codes(const absl::StatusOr<Mesh>& mesh) {
  if (!mesh.ok()) return {mesh.status().ToString()};
  std::vector<std::string> codes;
  for (const Warning& warning : mesh->warnings) codes.push_back(warning.code);
  return codes;
}

size_t Triangles(const absl::StatusOr<Mesh>& mesh) { return mesh.ok() ? mesh->triangles.size() : 0; }

std::string BinarySolid(uint32_t count, float last = 1) {
  std::string stl = std::string(80, ' ') + Bytes(count);
  for (int t = 0; t < 2; ++t) {
    for (const float f : {0.F, 0.F, 0.F, 0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, t == 1 ? last : 0.F}) stl += Bytes(f);
    stl += Bytes(uint16_t{0});
  }
  return stl;
}

std::string Wide(const std::string& text, bool big) {
  std::string wide = big ? "\xFE\xFF" : "\xFF\xFE";
  for (const char c : text) wide += big ? std::string{'\0', c} : std::string{c, '\0'};
  return wide;
}

class Tolerance : public FilesTest {};

TEST(PlyLines, WithMoreValuesThanTheHeaderTellsAreReadLineByLine) {
  const auto mesh = ParsePly(std::string(kPlyHead) + "3 0 1 2 9 1 1 1\n3 2 1 0 9 1 1 1\n");
  EXPECT_EQ(Triangles(mesh), 2u);
  ASSERT_THAT(Codes(mesh), ElementsAre("EXTRA_VALUES"));
  EXPECT_EQ(mesh->warnings[0].element, "line 13");
}

TEST(PlyLines, WithFewerValuesAreAnErrorThatNamesTheLine) {
  const auto mesh = ParsePly(std::string(kPlyHead) + "3 0 1 2\n3 2 1\n0\n");
  EXPECT_THAT(std::string(mesh.status().message()), HasSubstr("line 14: face 1 of 2 has fewer values"));
  EXPECT_THAT(Codes(ParsePly(std::string(kPlyHead) + "3 0 1 2\n3 2 1 0\n0\n")), ElementsAre("TRAILING_DATA"));
}

TEST(PlyHeader, MayEndLinesInCrAloneAndHaveUnmarkedComments) {
  const std::string text = absl::StrReplaceAll(std::string(kPlyHead) + "3 0 1 2\n3 2 1 0\n", {{"\n", "\r"}});
  EXPECT_EQ(Triangles(ParsePly(text)), 2u);
  std::string binary =
      "ply\rformat binary_little_endian 1.0\rwritten by hand\relement vertex 3\rproperty float x\rproperty float y\r"
      "property float z\relement face 1\rproperty list uchar int vertex_indices\rend_header\r";
  // The first byte of the data is a line feed.
  for (const float f : {std::ldexp(1.25F, -116), 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F}) binary += Bytes(f);
  binary += "\x03" + Bytes(std::array<int32_t, 3>{0, 1, 2});
  binary[binary.find("end_header\r") + 11] = '\n';
  const auto mesh = ParsePly(binary);
  EXPECT_EQ(Triangles(mesh), 1u);
  EXPECT_THAT(Codes(mesh), ElementsAre("UNKNOWN_HEADER"));
}

TEST(StlFile, OfSeveralBinarySolidsIsReadWhole) {
  const auto mesh = ParseStl(BinarySolid(2) + BinarySolid(2));
  EXPECT_EQ(Triangles(mesh), 4u);
  EXPECT_THAT(Codes(mesh), ElementsAre("SEVERAL_SOLIDS"));
  EXPECT_EQ(mesh->stretches.back().part, 1u);
  EXPECT_THAT(Codes(ParseStl(BinarySolid(2) + "more")), ElementsAre("TRAILING_DATA"));
}

// Returns a solid of two triangles: the first has a color of its own, (255, 8, 0), and the second that of the header.
std::string ColoredSolid() {
  std::string solid = BinarySolid(2);
  solid.replace(20, 10, "COLOR=\x01\x02\x03\xff");
  solid.replace(84 + 48, 2, Bytes(uint16_t{31 | 1 << 5}));
  solid.replace(84 + 98, 2, Bytes(uint16_t{0x8000}));
  return solid;
}

TEST(StlFile, HasTheColorsOfItsFacetsIfTheHeaderHasOne) {
  const auto mesh = ParseStl(ColoredSolid());
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  const Color own{255, 8, 0}, of_header{1, 2, 3};
  EXPECT_THAT(mesh->colors, ElementsAre(own, own, own, of_header, of_header, of_header));
  EXPECT_THAT(mesh->warnings, IsEmpty());
  EXPECT_THAT(ParseStl(BinarySolid(2))->colors, IsEmpty());
}

TEST(StlFile, SolidsWithoutColorsAreWhiteBesideColoredOnes) {
  for (const std::string& bytes : {ColoredSolid() + BinarySolid(2), BinarySolid(2) + ColoredSolid()}) {
    const auto mesh = ParseStl(bytes);
    EXPECT_THAT(Codes(mesh), ElementsAre("SEVERAL_SOLIDS", "PARTIAL_COLORS"));
    ASSERT_EQ(mesh->colors.size(), mesh->positions.size());
    EXPECT_THAT(mesh->colors, Contains(Color{255, 255, 255}).Times(6));
  }
}

TEST(StlFile, WithoutACountIsReadToItsEnd) {
  for (const uint32_t count : {0U, 0xFFFFFFFFU}) {
    const auto mesh = ParseStl(BinarySolid(count));
    EXPECT_EQ(Triangles(mesh), 2u);
    EXPECT_THAT(Codes(mesh), ElementsAre("NO_COUNT"));
  }
}

TEST(StlText, MayLackNormals) {
  for (const char* normal : {"facet normal\n", "facet\n", "facet normal 0 0\n", "facet normal "}) {
    const std::string facet = absl::StrReplaceAll(kFacet, {{"facet normal 0 0 0\n", normal}});
    const auto mesh = ParseStl(absl::StrCat("solid s\n", facet, kFacet, "endsolid s\n"));
    EXPECT_EQ(Triangles(mesh), 2u) << mesh.status();
  }
}

TEST(StlText, MayHaveWordsAfterItsKeywordsAndBytesAfterItsEnd) {
  const std::string solid = std::string("solid\n") + kFacet + "endsolid\n";
  const std::string words = absl::StrReplaceAll(solid, {{"endloop", "endloop blah"}, {"endfacet", "endfacet blah"}});
  EXPECT_EQ(Triangles(ParseStl(words)), 1u);
  EXPECT_EQ(Triangles(ParseStl(absl::StrReplaceAll(solid, {{"\n", "\r"}}))), 1u);
  const auto padded = ParseStl(solid + std::string(16, '\0'));
  EXPECT_EQ(Triangles(padded), 1u);
  EXPECT_THAT(Codes(padded), ElementsAre("TRAILING_DATA"));
  EXPECT_THAT(Codes(ParseStl(solid + "and more\n")), ElementsAre("TRAILING_DATA"));
}

TEST_F(Tolerance, OfCrAndUtf16AndGzip) {
  EXPECT_EQ(Triangles(ReadMesh(Write("cr.obj", absl::StrReplaceAll(kObj, {{"\n", "\r"}})))), 1u);
  EXPECT_EQ(Triangles(ReadMesh(Write("little.obj", Wide(kObj, false)))), 1u);
  EXPECT_EQ(Triangles(ReadMesh(Write("big.obj", Wide(kObj, true)))), 1u);
  EXPECT_EQ(Triangles(ReadMesh(Write("w.stl", Wide(std::string("solid\n") + kFacet + "endsolid\n", false)))), 1u);
}

TEST_F(Tolerance, OfAFormatThatTheExtensionDoesNotTell) {
  const auto mesh = ReadMesh(Write("obj.stl", kObj));
  EXPECT_EQ(Triangles(mesh), 1u);
  EXPECT_THAT(Codes(mesh), ElementsAre("FORMAT_MISMATCH"));
  EXPECT_THAT(std::string(ReadMesh("s3://bucket/mesh.obj").status().message()), HasSubstr("is a URL; latvox reads"));
}

TEST(ObjColors, AreReadOnTheScaleThatTheyHave) {
  const auto colors = [](const std::string& rgb) {
    const auto mesh = ParseObj(absl::StrReplaceAll("v 0 0 0 C\nv 1 0 0 C\nv 0 1 0 C\nf 1 2 3\n", {{"C", rgb}}));
    return mesh.ok() ? mesh->colors : std::vector<Color>();
  };
  EXPECT_THAT(colors("255 128 0"), Each(Color{255, 128, 0}));
  EXPECT_THAT(colors("1.0000001 0.5 0"), Each(Color{255, 128, 0}));
  EXPECT_THAT(colors("1.0 1 0.5 0"), Each(Color{255, 128, 0}));
  EXPECT_THAT(colors("-0.5 0.5 0"), IsEmpty());
  const auto partial = ParseObj("v 0 0 0\nv 1 0 0 1 0.5 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THAT(Codes(partial), ElementsAre("PARTIAL_COLORS"));
  EXPECT_THAT(partial->colors, ElementsAre(Color{255, 255, 255}, Color{255, 128, 0}, Color{255, 255, 255}));
}

TEST_F(Tolerance, OfMaterialFilesThatAreMissing) {
  const std::string obj = std::string("mtllib kd.mtl\n") + "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n";
  EXPECT_THAT(Codes(ReadMesh(Write("m.obj", obj))), ElementsAre("MISSING_FILE"));
  Write("kd.mtl", "newmtl red\nKd 1 0 0\n");
  const auto mesh = ReadMesh(Path("m.obj"));
  EXPECT_THAT(Codes(mesh), IsEmpty());
  EXPECT_THAT(mesh->colors, Each(Color{255, 0, 0}));
}

TEST(ObjFile, GroupsArePartsWhereThereAreNoObjects) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(ParseObj(vertices + "g a\nf 1 2 3\ng b\nf 3 2 1\n")->stretches.back().part, 1u);
  EXPECT_EQ(ParseObj(vertices + "o x\ng a\nf 1 2 3\ng b\nf 3 2 1\n")->stretches.back().part, 0u);
}

TEST(ObjFile, ElementsThatAreNoPolygonsAreCounted) {
  const auto mesh = ParseObj(std::string(kObj) + "curv 0 1 1 2\nvp 0 0\ncall x.obj\nblob 1 2\n");
  EXPECT_EQ(mesh->skipped, 4u);
  EXPECT_THAT(Codes(mesh), ElementsAre("SKIPPED_ELEMENTS"));
}

TEST(Quads, ThatAreConvexAreCutAlongCorners1And3) {
  const auto mesh = ParseObj("v 0 0 0\nv 1 0 1\nv 1 1 0\nv 0 1 1\nf 1 2 3 4\n");
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  using Triangle = std::array<uint32_t, 3>;
  EXPECT_THAT(mesh->triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
}

TEST(BadElements, AreErrorsOrLeftOutAndCounted) {
  const std::string obj = std::string(kObj) + "v nan 0 0\n";
  EXPECT_EQ(ParseObj(obj)->positions.size(), 3u);  // no face uses the last one
  const std::string broken = obj + "f 1 2\nf 1 2 9\nf 1 2 4\n";
  EXPECT_FALSE(ParseObj(broken).ok());
  const auto mesh = ParseObj(broken, {.skip_bad = true});
  EXPECT_EQ(Triangles(mesh), 1u);
  ASSERT_THAT(Codes(mesh), ElementsAre("BAD_ELEMENTS"));
  EXPECT_THAT(mesh->warnings[0].message, HasSubstr("3 broken elements are left out; the first: line 6"));
  EXPECT_EQ(Triangles(ParseStl(BinarySolid(2, NAN), {.skip_bad = true})), 1u);
  EXPECT_EQ(Triangles(ParsePly(std::string(kPlyHead) + "3 0 1 2\n3 2 1 7\n", {.skip_bad = true})), 1u);
}

TEST(Decode, UnpacksNoMoreThanTheLimit) {
  // 100 letters "a".
  std::string packed;
  ASSERT_TRUE(absl::Base64Unescape("H4sIAAAAAAACA0tMpD0AAGR6cK9kAAAA", &packed));
  std::vector<Warning> warnings;
  const auto all = Decode(packed, warnings);
  ASSERT_TRUE(all.ok()) << all.status();
  EXPECT_EQ(*all, std::string(100, 'a'));
  EXPECT_EQ(Decode(packed, warnings, 99).status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(Decode(packed.substr(0, 14), warnings).status().code(), absl::StatusCode::kInvalidArgument);
}

// The text of a continued statement is joined in a buffer, which the next one overwrites.
TEST(ObjTolerance, ElementsOfContinuedStatementsAreCountedByKind) {
  const auto mesh = ParseObj(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nl \\\n 1 2\ncurv \\\n 0 1 1 2 3 and so on, beyond any short text\nl 2 "
      "\\\n3\n");
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ(mesh->skipped, 3u);
  ASSERT_EQ(mesh->warnings.size(), 1u);
  EXPECT_THAT(mesh->warnings[0].message, HasSubstr("1 \"curv\", 2 \"l\""));
}

}  // namespace
}  // namespace latvox::client
