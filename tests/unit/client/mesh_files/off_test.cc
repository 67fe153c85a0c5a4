// OFF files: Geomview's, and as CGAL, MeshLab and others write them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "client/mesh_files/mesh_file.h"
#include "client/mesh_files/mesh_format.h"
#include "client/mesh_files/off_file.h"
#include "tests/unit/client/files.h"

namespace latvox::client {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

using Triangle = std::array<uint32_t, 3>;

constexpr Color kRed{255, 0, 0}, kWhite{255, 255, 255};
constexpr char kVertices[] = "0 0 0\n1 0 0\n1 1 0\n0 1 0.1\n";
constexpr char kSquare[] = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0.1\n3 0 1 2\n3 0 2 3\n";

std::string Refusal(const std::string& bytes) { return std::string(ParseOff(bytes).status().message()); }

std::vector<std::string> Codes(const absl::StatusOr<Mesh>& mesh) {
  if (!mesh.ok()) return {mesh.status().ToString()};
  std::vector<std::string> codes;
  for (const Warning& warning : mesh->warnings) codes.push_back(warning.code);
  return codes;
}

void ExpectSquare(const absl::StatusOr<Mesh>& mesh) {
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_THAT(mesh->positions, ElementsAre(Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{1, 1, 0}, Vec3d{0, 1, 0.1}));
  EXPECT_THAT(mesh->triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
  EXPECT_THAT(mesh->colors, IsEmpty());
  EXPECT_THAT(Codes(mesh), IsEmpty());
}

TEST(OffFile, HeadersAreReadAsProgramsWriteThem) {
  const std::string body = absl::StrCat(kVertices, "3 0 1 2\n3 0 2 3\n");
  for (const char* header : {"OFF\n4 2 0\n", "OFF 4 2 0\n", "OFF4 2 0\n", "OFF\n4 2\n", "4 2 0\n", "off\n4 2 0\n",
                             "# a comment\n\nOFF # more\n# 1 2 3\n4 2 5 # counts\n\n"}) {
    SCOPED_TRACE(header);
    ExpectSquare(ParseOff(header + body));
  }
  ExpectSquare(ParseOff(absl::StrReplaceAll(kSquare, {{"\n", "\r"}})));
  ExpectSquare(ParseOff(absl::StrReplaceAll(kSquare, {{"\n", " # x\r\n\r\n"}})));
}

TEST(OffFile, PolygonsAreCutAndFacesWithoutASurfaceAreCounted) {
  const auto mesh = ParseOff(absl::StrCat("OFF\n4 3 0\n", kVertices, "4 0 1 2 3\n2 0 1\n1 0\n"));
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_THAT(mesh->triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
  EXPECT_EQ(mesh->skipped, 2u);
  EXPECT_THAT(Codes(mesh), ElementsAre("SKIPPED_ELEMENTS"));
}

// Normals come before colors, and texture coordinates after them, whatever the order of the letters.
TEST(OffFile, VerticesMayHaveNormalsColorsAndTextureCoordinates) {
  const auto colors = [](const std::string& keyword, const std::string& more) {
    const auto mesh =
        ParseOff(keyword + "\n3 1 0\n0 0 0 " + more + "\n1 0 0 " + more + "\n0 1 0 " + more + "\n3 0 1 2\n");
    EXPECT_THAT(Codes(mesh), IsEmpty());
    if (!mesh.ok()) return std::vector<Color>();
    EXPECT_EQ(mesh->positions[1], (Vec3d{1, 0, 0}));
    return mesh->colors;
  };
  EXPECT_THAT(colors("NOFF", "7 8 9"), IsEmpty());
  EXPECT_THAT(colors("STOFF", "7 8"), IsEmpty());
  EXPECT_THAT(colors("COFF", "1 0.5 0 1"), Each(Color{255, 128, 0}));
  EXPECT_THAT(colors("COFF", "1.0 0.5 0"), Each(Color{255, 128, 0}));
  EXPECT_THAT(colors("COFF", "255 128 0 255"), Each(Color{255, 128, 0}));
  EXPECT_THAT(colors("COFF", "255 128 0"), Each(Color{255, 128, 0}));
  EXPECT_THAT(colors("coff", "1 0 0"), Each(kRed));
  EXPECT_THAT(colors("CNOFF", "7 8 9 255 0 0"), Each(kRed));
  EXPECT_THAT(colors("STCNOFF", "7 8 9 255 0 0 7 8"), Each(kRed));
  EXPECT_THAT(colors("NCSTOFF", "7 8 9 255 0 0 255 7 8"), Each(kRed));
}

TEST(OffFile, ColorsOfFacesAreThoseOfTheirTriangles) {
  const auto of_faces = [](const std::string& first, const std::string& second) {
    return ParseOff(absl::StrCat("OFF\n4 2 0\n", kVertices, "3 0 1 2 ", first, "\n3 0 2 3 ", second, "\n"));
  };
  const auto mesh = of_faces("255 0 0", "0 255 0 255");
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_THAT(Codes(mesh), IsEmpty());
  ASSERT_EQ(mesh->colors.size(), mesh->positions.size());
  EXPECT_EQ(mesh->colors[mesh->triangles[0][2]], kRed);
  EXPECT_EQ(mesh->colors[mesh->triangles[1][1]], (Color{0, 255, 0}));
  // Integers and other numbers have different scales in one file.
  const auto mixed = of_faces("128 0 2", "0.0 0.5 1.0");
  ASSERT_TRUE(mixed.ok()) << mixed.status();
  EXPECT_EQ(mixed->colors[mixed->triangles[0][0]], (Color{128, 0, 2}));
  EXPECT_EQ(mixed->colors[mixed->triangles[1][0]], (Color{0, 128, 255}));
  const auto partial = of_faces("", "1.0 0 0");
  EXPECT_THAT(Codes(partial), ElementsAre("PARTIAL_COLORS"));
  EXPECT_EQ(partial->colors[partial->triangles[0][0]], kWhite);
  EXPECT_EQ(partial->colors[partial->triangles[1][0]], kRed);
  const auto indexed = of_faces("5", "7");
  EXPECT_THAT(Codes(indexed), ElementsAre("IGNORED_COLOR"));
  EXPECT_THAT(indexed->colors, IsEmpty());
  const auto wrong = of_faces("300 0 0", "0 0 0");
  ASSERT_TRUE(wrong.ok()) << wrong.status();
  EXPECT_THAT(wrong->colors, IsEmpty());
  EXPECT_EQ(wrong->no_color, "color 300 of triangle 0 is not within 0 and 255");
}

TEST(OffFile, ColorsOfVerticesCountBesideThoseOfFaces) {
  const auto mesh = ParseOff("COFF\n3 1 0\n0 0 0 1 0 0 1\n1 0 0 1 0 0 1\n0 1 0 1 0 0 1\n3 0 1 2 0 255 0\n");
  EXPECT_THAT(Codes(mesh), ElementsAre("IGNORED_COLOR"));
  EXPECT_THAT(mesh->colors, Each(kRed));
  const auto none = ParseOff("COFF\n3 1 0\n0 0 0 x 0 0 1\n1 0 0 1 0 0 1\n0 1 0 1 0 0 1\n3 0 1 2\n");
  ASSERT_TRUE(none.ok()) << none.status();
  EXPECT_THAT(none->no_color, HasSubstr("of vertex 0 is not within 0 and 1"));
}

TEST(OffFile, ErrorsNameLineValueAndLimit) {
  const auto says = [](const std::string& bytes, const char* text) { EXPECT_THAT(Refusal(bytes), HasSubstr(text)); };
  const std::string counts = "OFF\n4 2 0\n", vertices = counts + kVertices;
  says("4OFF\n1 0 0\n0 0 0 1\n", "line 1: 4OFF has vertices of four numbers; latvox reads OFF, COFF, NOFF, STOFF");
  says("nOFF\n3\n1 0 0\n0 0 0\n", "line 1: nOFF has vertices of any dimension");
  says("4nOFF\n3\n", "line 1: nOFF has vertices of any dimension");
  says("OFFICE 1 2\n", "not an OFF file: it begins with \"OFFICE\"");
  says("COCOFF\n", "not an OFF file: it begins with \"COCOFF\"");
  says("# nothing\n", "not an OFF file: it has no words");
  says("OFF\n", "ends after the keyword OFF");
  says("OFF\n4\n", "line 2: \"4\" does not begin a line of the numbers of vertices, faces and edges");
  says("OFF\n4 -2 0\n", "line 2: \"4\" does not begin");
  says("OFF\n4 2 0 0 0 0\n", "line 2: \"4\" does not begin");
  says("OFF\n\n# x\n99999999999999999999 2 0\n", "line 4: \"99999999999999999999\" does not begin");
  says(counts + "0 0 0\n1 0\n", "line 4: vertex 1 has 2 numbers, not 3");
  says("NOFF\n1 0 0\n0 0 0 1\n", "line 3: vertex 0 has 4 numbers, not 6");
  says("COFF\n1 0 0\n0 0 0 1 2\n", "line 3: vertex 0 has a color of 2 numbers, not 3 or 4");
  says("COFF\n1 0 0\n0 0 0\n", "line 3: vertex 0 has a color of 0 numbers, not 3 or 4");
  says(counts + "0 x 0\n", "line 3: coordinate \"x\" of vertex 0 is not a number");
  says(counts + "0 0 0\n", "ends at vertex 1 of 4");
  says("OFF\n18446744073709551615 1 0\n0 0 0\n", "ends at vertex 1 of 18446744073709551615");
  says(vertices + "3 0 1 2\n", "ends at face 1 of 2");
  says(vertices + "3 0 1\n", "line 7: face 0 has 2 corners, not 3");
  says(vertices + "3 0 1 4\n", "line 7: vertex index 4 of face 0 is not within the 4 vertices");
  says(vertices + "3 0 1 -1\n", "line 7: vertex index -1 of face 0");
  says(vertices + "3 0 1 1.5\n", "line 7: vertex index 1.5 of face 0");
  says(vertices + "3 0 1 x\n", "line 7: vertex index \"x\" of face 0 is not a number");
  says(vertices + "x 0 1 2\n", "line 7: \"x\" is not the number of corners of face 0");
  says(vertices + "1e300 0 1 2\n", "line 7: face 0 has 3 corners, not 1e+300");
  says("OFF\n3 1 0\n0 0 nan\n1 0 0\n0 1 0\n3 0 1 2\n", "line 6: vertex 0 is not finite (0 0 nan), and face 0 uses it");
}

TEST(OffFile, WhatTheHeaderDoesNotTellIsAWarning) {
  const auto extra = ParseOff("OFF\n3 1 0\n0 0 0 9\n1 0 0 9\n0 1 0 9\n3 0 1 2 1 2 3 4 5\n");
  EXPECT_THAT(Codes(extra), ElementsAre("EXTRA_VALUES"));
  EXPECT_THAT(extra->warnings[0].message, HasSubstr("4 lines have more values"));
  EXPECT_EQ(extra->warnings[0].element, "line 3");
  const auto trailing = ParseOff(std::string(kSquare) + "# a comment\n3 0 1 3\n");
  EXPECT_THAT(Codes(trailing), ElementsAre("TRAILING_DATA"));
  EXPECT_EQ(trailing->warnings[0].element, "line 10");
}

TEST(OffFile, BrokenElementsAreLeftOutOnRequest) {
  const auto mesh = ParseOff(
      "COFF\n5 4 0\n0 0 0 1 0 0\n1 0 0 1 0 0\n0 1\n0 x 0 1 0 0\n0 1 0 1 0 0\n3 0 1 4\n3 0 1 2\n3 0 1\n3 0 1 9\n",
      {.skip_bad = true});
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_THAT(mesh->triangles, ElementsAre(Triangle{0, 1, 2}));
  EXPECT_THAT(mesh->positions, ElementsAre(Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0}));
  EXPECT_THAT(mesh->colors, ElementsAre(kRed, kRed, kRed));
  ASSERT_THAT(Codes(mesh), ElementsAre("BAD_ELEMENTS"));
  EXPECT_THAT(mesh->warnings[0].message,
              HasSubstr("5 broken elements are left out; the first: line 5: vertex 2 has 2"));
}

// A number as Geomview stores it.
template <class T>
std::string Big(T number) {
  std::string bytes = Bytes(number);
  std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

// A square of two faces. The colors of the first are `color`.
std::string BinaryOff(const std::string& keyword = "OFF", const std::vector<float>& more = {},
                      const std::vector<float>& color = {}, int32_t last_index = 3) {
  std::string bytes = keyword + " BINARY\n" + Big(int32_t{4}) + Big(int32_t{2}) + Big(int32_t{5});
  for (const auto& [x, y, z] : std::vector<std::array<float, 3>>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.25F}}) {
    bytes += Big(x) + Big(y) + Big(z);
    for (const float number : more) bytes += Big(number);
  }
  bytes += Big(int32_t{3}) + Big(int32_t{0}) + Big(int32_t{1}) + Big(int32_t{2});
  bytes += Big(static_cast<int32_t>(color.size()));
  for (const float number : color) bytes += Big(number);
  return bytes + Big(int32_t{3}) + Big(int32_t{0}) + Big(int32_t{2}) + Big(last_index) + Big(int32_t{0});
}

TEST(OffFile, BinaryNumbersAreBigEndian) {
  for (const std::string& bytes : {BinaryOff(), BinaryOff("NOFF", {7, 8, 9}), BinaryOff("STOFF", {7, 8})}) {
    const auto mesh = ParseOff(bytes);
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    EXPECT_EQ(mesh->positions[3], (Vec3d{0, 1, 0.25}));
    EXPECT_THAT(mesh->triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
    EXPECT_THAT(Codes(mesh), IsEmpty());
  }
  EXPECT_THAT(ParseOff(BinaryOff("STCNOFF", {7, 8, 9, 1, 0, 0, 1, 7, 8})).value().colors, Each(kRed));
  const auto faces = ParseOff(BinaryOff("OFF", {}, {1, 0, 0, 0.5F}));
  EXPECT_THAT(Codes(faces), ElementsAre("PARTIAL_COLORS"));
  EXPECT_EQ(faces->colors[faces->triangles[0][1]], kRed);
  EXPECT_THAT(Codes(ParseOff(BinaryOff("OFF", {}, {3}))), ElementsAre("IGNORED_COLOR"));
  EXPECT_THAT(Codes(ParseOff(BinaryOff() + "more")), ElementsAre("TRAILING_DATA"));
}

TEST(OffFile, BinaryErrorsNameTheElement) {
  EXPECT_THAT(Refusal(BinaryOff("OFF", {}, {}, 4)), HasSubstr("vertex index 4 of face 1 is not within the 4 vertices"));
  EXPECT_EQ(ParseOff(BinaryOff("OFF", {}, {}, 4), {.skip_bad = true}).value().triangles.size(), 1u);
  EXPECT_THAT(Refusal(BinaryOff("OFF", {}, {1, 2})), HasSubstr("face 0 has a color of 2 numbers, not 0, 1, 3 or 4"));
  EXPECT_THAT(Refusal("OFF BINARY\n" + Big(int32_t{-4}) + Big(int32_t{2}) + Big(int32_t{0})),
              HasSubstr("the numbers of vertices and faces, -4 and 2, are damaged or cut short"));
  const std::string many = "OFF BINARY\n" + Big(int32_t{2147483647}) + Big(int32_t{2147483647}) + Big(int32_t{0});
  EXPECT_THAT(Refusal(many + Big(0.F) + Big(0.F) + Big(0.F)), HasSubstr("ends at vertex 1 of 2147483647"));
  EXPECT_THAT(Refusal("OFF BINARY\n" + Big(int32_t{0}) + Big(int32_t{1}) + Big(int32_t{0}) + Big(int32_t{-1}) +
                      Big(int32_t{0})),
              HasSubstr("face 0 has -1 corners"));
}

TEST(OffFile, EveryTruncationIsAnErrorAndMutationsGiveAnErrorOrAMesh) {
  const std::string binary = BinaryOff("COFF", {1, 0, 0, 1}, {1, 0, 0});
  for (size_t length = 0; length < binary.size(); ++length) {
    EXPECT_FALSE(ParseOff(binary.substr(0, length)).ok()) << length;
  }
  const std::string text = kSquare;
  for (size_t length = 0; length + 2 < text.size(); ++length) {
    EXPECT_FALSE(ParseOff(text.substr(0, length)).ok()) << length;
  }
  for (const std::string& whole : {binary, text}) {
    size_t errors = 0;
    for (size_t at = 0; at < whole.size(); ++at) {
      for (const int flip : {1, 2, 16, 128, 255}) {
        std::string bytes = whole;
        bytes[at] = static_cast<char>(bytes[at] ^ flip);
        const auto mesh = ParseOff(bytes);
        errors += !mesh.ok();
        if (!mesh.ok()) continue;
        EXPECT_THAT(mesh->triangles, Each(Each(testing::Lt(mesh->positions.size()))));
      }
    }
    EXPECT_GT(errors, whole.size());
  }
}

class OffFiles : public FilesTest {};

TEST_F(OffFiles, AreRecognizedByExtensionAndByFirstBytes) {
  ExpectSquare(ReadMesh(Write("m.OFF", std::string("\xEF\xBB\xBF") + kSquare)));
  EXPECT_THAT(Codes(ReadMesh(Write("m.stl", kSquare))), ElementsAre("FORMAT_MISMATCH"));
  std::string wide = "\xFF\xFE";
  for (const char c : std::string(kSquare)) wide += {c, '\0'};
  ExpectSquare(ReadMesh(Write("w.off", wide)));
  for (const std::string& bytes : {std::string("# x\nCOFF\n"), std::string("OFF 8 6 12\n"), std::string("OFF8 6 12\n"),
                                   std::string("4OFF\n"), std::string("nOFF\n3"), BinaryOff()}) {
    EXPECT_EQ(FormatOfBytes(bytes), MeshFormat::kOff) << bytes;
  }
  for (const char* none : {"off the record\n", "OFFICE\n", "OFF x\n", "COO 1 2\n"}) {
    EXPECT_EQ(FormatOfBytes(none), std::nullopt) << none;
  }
}

}  // namespace
}  // namespace latvox::client
