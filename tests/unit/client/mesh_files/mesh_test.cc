#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "absl/strings/escaping.h"
#include "client/mesh/mesh_encoder.h"
#include "client/mesh_files/draco_file.h"
#include "client/mesh_files/input.h"
#include "client/mesh_files/mesh_file.h"
#include "client/mesh_files/obj_file.h"
#include "client/mesh_files/ply_file.h"
#include "client/mesh_files/stl_file.h"
#include "client/mesh_files/zip_archive.h"
#include "tests/unit/client/files.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using Triangle = std::array<uint32_t, 3>;

std::string Message(const absl::Status& status) { return std::string(status.message()); }

TEST(ObjFile, NumbersAreTheNearestDoubles) {
  const auto mesh = ParseObj("v -3.85359e-05 7.70718e-05 +0.1\nv 691603.5625001 1e-500 -0\nv 1 2 3\nf 1 2 3\n");
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_THAT(mesh->positions[0], ElementsAre(-3.85359e-05, 7.70718e-05, 0.1));
  EXPECT_THAT(mesh->positions[1], ElementsAre(691603.5625001, 0., -0.));
}

TEST(ObjFile, IndicesCountBackwardsAndForwardsAndAcrossContinuedLines) {
  const auto mesh = ParseObj("f 1 2 \\\r\n 3\r\nv 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf -3 -2 -1\r\nv 5 5 5\r\n");
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_THAT(mesh->triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 1, 2}));
}

TEST(ObjFile, LinesAndPointsAreCountedAsSkippedAndDegenerateTrianglesKept) {
  const auto mesh = ParseObj("v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\np 3\nf 1 1 2\nf 1 2 3\nf 1 2 3\n");
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ(mesh->skipped, 2u);
  EXPECT_EQ(mesh->triangles.size(), 3u);
}

TEST(ObjFile, ErrorsNameLineValueAndLimit) {
  const std::string good = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_THAT(Message(ParseObj(good + "f 1 2 9\n").status()), HasSubstr("line 4: vertex index 9"));
  EXPECT_THAT(Message(ParseObj(good + "f 1 2 9\n").status()), HasSubstr("3 vertices"));
  EXPECT_THAT(Message(ParseObj(good + "f 0 1 2\n").status()), HasSubstr("vertex index 0"));
  EXPECT_THAT(Message(ParseObj(good + "f -4 1 2\n").status()), HasSubstr("vertex index -4"));
  EXPECT_THAT(Message(ParseObj(good + "f 1 2 99999999999999999999\n").status()), HasSubstr("99999999999999999999"));
  EXPECT_THAT(Message(ParseObj(good + "f 1 x 3\n").status()), HasSubstr("\"x\""));
  EXPECT_THAT(Message(ParseObj(good + "f 1 2\n").status()), HasSubstr("2 corners"));
  EXPECT_THAT(Message(ParseObj(good + "v 0 nan 0\nf 1 2 4\n").status()),
              HasSubstr("line 5: vertex 4 of a face is not finite (0 nan 0)"));
  EXPECT_THAT(Message(ParseObj(good + "v 0 1e999 0\nf 1 2 4\n").status()), HasSubstr("vertex 4 of a face"));
  EXPECT_THAT(Message(ParseObj("v 0 1\n").status()), HasSubstr("is not a number"));
}

// A PLY file of four vertices and two triangles in one of the binary formats.
std::string BinaryPly(bool big_endian, int32_t last_index, float last_coordinate = 0.25F) {
  std::string ply = std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
                    "_endian 1.0\ncomment x\nelement vertex 4\nproperty uchar red\nproperty float x\n"
                    "property double y\nproperty float z\nelement face 2\nproperty list uchar int vertex_indices\n"
                    "property short flag\nend_header\n";
  const auto append = [&](auto value) {
    std::string bytes = Bytes(value);
    if (big_endian) std::reverse(bytes.begin(), bytes.end());
    ply += bytes;
  };
  for (int n = 0; n < 4; ++n) {
    append(uint8_t{7});
    append(static_cast<float>(n & 1));
    append(static_cast<double>(n >> 1));
    append(n == 3 ? last_coordinate : 0.F);
  }
  for (const auto& face : {std::array<int32_t, 3>{0, 1, 2}, {1, 3, last_index}}) {
    append(uint8_t{3});
    for (const int32_t index : face) append(index);
    append(int16_t{-1});
  }
  return ply;
}

TEST(PlyFile, ReadsEitherByteOrderAndSkipsWhatItDoesNotNeed) {
  for (const bool big_endian : {false, true}) {
    const auto mesh = ParsePly(BinaryPly(big_endian, 2));
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    EXPECT_THAT(mesh->positions[3], ElementsAre(1.F, 1.F, 0.25F));
    EXPECT_THAT(mesh->triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{1, 3, 2}));
  }
}

TEST(PlyFile, EveryTruncationIsAnErrorAndNoneCrashes) {
  const std::string whole = BinaryPly(false, 2);
  for (size_t length = 0; length < whole.size(); ++length) {
    EXPECT_FALSE(ParsePly(whole.substr(0, length)).ok()) << length;
  }
}

TEST(PlyFile, ReadsAsciiWithQuadsAndCountsWhatIsNoFace) {
  const auto mesh = ParsePly(
      "ply\r\nformat ascii 1.0\r\nelement vertex 4\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\n"
      "element face 2\r\nproperty list uchar uint vertex_index\r\nend_header\r\n"
      "0 0 0\r\n1 0 0\r\n1 1 7.70718e-05\r\n0 1 0\r\n4 0 1 2 3\r\n2 0 1\r\n");
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ(mesh->positions[2][2], 7.70718e-05);
  EXPECT_EQ(mesh->triangles.size(), 2u);
  EXPECT_EQ(mesh->skipped, 1u);
}

TEST(PlyFile, StripsAreTrianglesOfOneSense) {
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement tristrips 1\nproperty list int int ";
  const std::string vertices = "\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
  const auto mesh = ParsePly(head + "vertex_indices" + vertices + "9 0 1 2 3 -1 1 3 2 0\n");
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_THAT(mesh->triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{2, 1, 3}, Triangle{1, 3, 2}, Triangle{2, 3, 0}));
  const auto says = [&](const std::string& list, const std::string& body, const char* text) {
    EXPECT_THAT(Message(ParsePly(head + list + vertices + body).status()), HasSubstr(text));
  };
  says("vertex_indices", "3 0 1 4\n", "vertex index 4 of tristrips 0 is not within the 4 vertices");
  says("vertex_indices", "3 0 1\n", "line 14: tristrips 0 of 1 has fewer values than the header tells");
  says("vertex_indices", "", "ends or is damaged at tristrips 0 of 1");
  says("indices", "3 0 1 2\n", "element tristrips has no list vertex_indices");
}

TEST(PlyFile, ErrorsNameVertexFaceAndLimit) {
  EXPECT_THAT(Message(ParsePly(BinaryPly(false, 99)).status()), HasSubstr("vertex index 99 of face 1"));
  EXPECT_THAT(Message(ParsePly(BinaryPly(false, -1)).status()), HasSubstr("vertex index -1 of face 1"));
  EXPECT_THAT(Message(ParsePly(BinaryPly(true, 2, NAN)).status()),
              HasSubstr("vertex 3 is not finite (1 1 nan), and face 1"));
  EXPECT_THAT(Message(ParsePly("ply\nformat ascii 1.0\nelement vertex 18446744073709551615\nproperty float x\n"
                               "property float y\nproperty float z\nend_header\n1 2 3\n")
                          .status()),
              HasSubstr("vertex 1 of 18446744073709551615"));
  EXPECT_FALSE(ParsePly("plyx\n").ok());
}

class MeshFile : public FilesTest {};

TEST(DracoFile, HasTheColorsOfItsVertices) {
  const Mesh mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                  .triangles = {{0, 1, 2}},
                  .colors = {{255, 0, 0}, {0, 100, 0}, {1, 2, 3}}};
  const auto read = ParseDraco(EncodeMesh(mesh, 0, {Field::kColor}).value().drc);
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->colors.size(), 3u);
  for (size_t n = 0; n < 3; ++n) {
    const auto place = std::find(mesh.positions.begin(), mesh.positions.end(), read->positions[n]);
    ASSERT_NE(place, mesh.positions.end());
    EXPECT_EQ(read->colors[n], mesh.colors[static_cast<size_t>(place - mesh.positions.begin())]);
  }
  EXPECT_THAT(ParseDraco(EncodeMesh(mesh, 0).value().drc)->colors, testing::IsEmpty());
}

std::string BinaryStl(uint32_t triangles) {
  std::string stl(80, ' ');
  stl += Bytes(triangles);
  for (uint32_t n = 0; n < triangles; ++n) {
    const float z = static_cast<float>(n);
    for (const float f : {0.F, 0.F, 1.F, 0.F, 0.F, z, 1.F, 0.F, z, 0.F, 0.1F, z}) stl += Bytes(f);
    stl += Bytes(uint16_t{0});
  }
  return stl;
}

TEST_F(MeshFile, ReadsBinaryStlBitByBit) {
  const auto mesh = ReadMesh(Write("m.stl", BinaryStl(2)));
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  ASSERT_EQ(mesh->triangles.size(), 2u);
  EXPECT_THAT(mesh->positions[mesh->triangles[1][2]], ElementsAre(0.F, 0.1F, 1.F));
}

TEST_F(MeshFile, ReadsAsciiStl) {
  const auto mesh =
      ReadMesh(Write("m.STL",
                     "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0.5\nendloop\n"
                     "endfacet\nendsolid s\n"));
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  ASSERT_EQ(mesh->triangles.size(), 1u);
  EXPECT_THAT(mesh->positions[2], ElementsAre(0.F, 1.F, 0.5F));
}

TEST(StlFile, TextIsReadToTheNearestDoublesInAnyCaseAndLayout) {
  const auto mesh = ParseStl(
      "SOLID vertex of a facet\n  FACET NORMAL 0 0 1 outer loop\nVertex -3.85359e-05 7.70718e-05 +0.1\n"
      "vertex 1 0 0 vertex 0 1e-50 0\nendloop endfacet\nendsolid\nsolid\nfacet normal nan nan nan\nouter loop\n"
      "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid vertex\n");
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_THAT(mesh->positions[0], ElementsAre(-3.85359e-05, 7.70718e-05, 0.1));
  EXPECT_THAT(mesh->triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{3, 4, 5}));
}

TEST(StlFile, ErrorsNameLineOrTriangle) {
  const std::string head = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
  const auto says = [](const std::string& bytes, const char* text) {
    EXPECT_THAT(Message(ParseStl(bytes).status()), HasSubstr(text));
  };
  says(head + "vertex 0 x 0\n", "line 6: coordinate \"x\" of a vertex is not a finite number");
  says(head + "vertex 0 1e999 0\n", "line 6: coordinate \"1e999\"");
  says(head + "vertex 0 1", "line 6: coordinate \"\"");
  says(head + "endloop\n", "line 6: a facet has 2 vertices, not 3");
  says(head + "vortex 0 1 0\n", "line 6: \"vortex\" is not an STL keyword");
  says(head, "ends within a facet");
  says(BinaryStl(2).substr(0, 150), "ends within triangle 1 of 2");
  says(BinaryStl(2).substr(0, 83), "is not an STL file");
  const std::string solid = "solid" + BinaryStl(2).substr(5);
  says(solid.substr(0, 150), "ends within triangle 1 of 2");
  EXPECT_EQ(ParseStl(solid + "more")->triangles.size(), 2u);
  std::string bytes = BinaryStl(2);
  bytes.replace(84 + 50 + 12 + 8, 4, Bytes(std::numeric_limits<float>::infinity()));
  says(bytes, "a vertex of triangle 1 is not finite (inf)");
}

// One triangle under two nested nodes, embedded in base64: positions (0,0,0) (1,0,0) (0,1,0), indices 0 1 `last`.
std::string Gltf(const std::string& data, const std::string& nodes, int bytes = 44) {
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" + nodes +
         R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"buffers":[{"byteLength":)" +
         std::to_string(bytes) + R"(,"uri":"data:application/octet-stream;base64,)" + data +
         R"("}],"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
         "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
         {"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}]})";
}

constexpr char kTriangle[] = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIAAAA=";
constexpr char kBadIndex[] = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAkAAAA=";

TEST_F(MeshFile, AppliesNestedNodeTransformsOfGltfToEveryInstance) {
  const auto mesh = ReadMesh(Write(
      "m.gltf", Gltf(kTriangle, R"({"children":[1,2],"translation":[10,0,0]},{"mesh":0,"scale":[2,3,4]},{"mesh":0})")));
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  ASSERT_EQ(mesh->triangles.size(), 2u);
  EXPECT_THAT(mesh->positions, ElementsAre(Vec3d{10, 0, 0}, Vec3d{12, 0, 0}, Vec3d{10, 3, 0},  //
                                           Vec3d{10, 0, 0}, Vec3d{11, 0, 0}, Vec3d{10, 1, 0}));
}

TEST_F(MeshFile, ErrorsNameTheFile) {
  const auto fails = [this](const std::string& name, const std::string& bytes) {
    const auto mesh = ReadMesh(Write(name, bytes));
    EXPECT_EQ(mesh.status().code(), absl::StatusCode::kInvalidArgument) << name;
    EXPECT_THAT(Message(mesh.status()), HasSubstr(name));
  };
  fails("empty.obj", "");
  fails("empty.stl", "");
  fails("text.obj", "this is no mesh\n");
  fails("text.ply", "this is no mesh\n");
  fails("text.stl", "this is no mesh\n");
  fails("text.glb", "this is no mesh\n");
  fails("text.gltf", "this is no mesh\n");
  fails("cut.stl", BinaryStl(2).substr(0, 150));
  fails("points.obj", "v 0 0 0\nv 1 0 0\n");
  fails("index.gltf", Gltf(kBadIndex, R"({"mesh":0})"));
  fails("cut.gltf", Gltf(kTriangle, R"({"mesh":0})", 400));
  fails("mesh.xyz", "v 0 0 0\n");
  EXPECT_EQ(ReadMesh(Path("missing.stl")).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(ReadMesh(Path("")).status().code(), absl::StatusCode::kInvalidArgument);
}

// A reader that checks only for the end of such a file would take it for empty, or for complete.
TEST_F(MeshFile, WhatFailsToBeReadIsNoShortFile) {
  const auto bytes = ReadBytes("/proc/self/mem");
  EXPECT_EQ(bytes.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(Message(bytes.status()), "/proc/self/mem: cannot be read to its end (Input/output error)");
}

TEST_F(MeshFile, AByteOrderMarkIsNoPartOfAText) {
  const std::string facet =
      "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  for (const auto& [name, text] : {std::pair<std::string, std::string>("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
                                   {"m.stl", "solid\n" + facet + "endsolid\n"},
                                   {"m.ply", ply},
                                   {"m.gltf", Gltf(kTriangle, R"({"mesh":0})")}}) {
    const std::string marked = "\xEF\xBB\xBF" + text;
    const auto mesh = ReadMesh(Write(name, marked));
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    EXPECT_THAT(mesh->positions, ElementsAre(Vec3d{0, 0, 0}, Vec3d{1, 0, 0}, Vec3d{0, 1, 0})) << name;
    EXPECT_EQ(FormatOfBytes(marked), FormatOfPath(name)) << name;
  }
}

TEST(MeshFormat, IsToldByTheFirstBytes) {
  const auto is = [](absl::string_view bytes, MeshFormat format) { EXPECT_EQ(FormatOfBytes(bytes), format) << bytes; };
  is("DRACO\x02", MeshFormat::kDraco);
  is("ply\r\nformat", MeshFormat::kPly);
  is("glTF\x02", MeshFormat::kGlb);
  is("PK\x03\x04", MeshFormat::kThreeMf);
  is(" \n{\"asset\":", MeshFormat::kGltf);
  is("solid s\n", MeshFormat::kStl);
  is(BinaryStl(2), MeshFormat::kStl);
  is("solid" + BinaryStl(1).substr(5), MeshFormat::kStl);
  is("# a comment\no name\n\tv 0 0 0\n", MeshFormat::kObj);
  for (const absl::string_view none : {"", "plywood\n", "vertex 0 0 0\n", "x v 0 0 0", "<svg/>"}) {
    EXPECT_EQ(FormatOfBytes(none), std::nullopt) << none;
  }
  EXPECT_EQ(FormatOfBytes(absl::string_view("\0v\nv 0 0 0\n", 11)), std::nullopt);
}

TEST(ZipArchive, UnpacksNoMoreThanTheLimit) {
  // An entry "a" of a thousand letters in 11 bytes.
  std::string bytes;
  ASSERT_TRUE(
      absl::Base64Unescape("UEsDBBQAAAAIAAAAIQAD2jiaCwAAAOgDAAABAAAAYUtMHAWjYBQMdwAAUEsBAhQDFAAAAAgAAA"
                           "AhAAPaOJoLAAAA6AMAAAEAAAAAAAAAAAAAAIABAAAAAGFQSwUGAAAAAAEAAQAvAAAAKgAAAAAA",
                           &bytes));
  auto wide = ZipArchive::Open(bytes, 1000);
  ASSERT_TRUE(wide.ok()) << wide.status();
  EXPECT_EQ(wide->Read("a").value(), std::string(1000, 'a'));
  EXPECT_EQ(wide->Read("a").status().code(), absl::StatusCode::kResourceExhausted);  // of all entries together
  auto narrow = ZipArchive::Open(bytes, 999);
  ASSERT_TRUE(narrow.ok());
  EXPECT_THAT(Message(narrow->Read("a").status()), HasSubstr("\"a\" unpacks to more than the limit of 999 bytes"));
  EXPECT_THAT(Message(narrow->Read("b").status()), HasSubstr("\"b\""));
  EXPECT_EQ(ZipArchive::Open("PK", 1000).status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace latvox::client
