// Attributes of meshes: as read from files, joined, and encoded.
#include <draco/compression/decode.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <map>
#include <string>
#include <vector>

#include "client/mesh/mesh_attributes.h"
#include "client/mesh/mesh_encoder.h"
#include "client/mesh_files/gltf_file.h"
#include "client/mesh_files/mesh_join.h"
#include "client/mesh_files/obj_file.h"
#include "client/mesh_files/ply_file.h"
#include "client/mesh_files/stl_file.h"

namespace latvox::client {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;

// Returns the numbers of all triangles' first corners.
std::vector<uint32_t> NumbersOf(const Mesh& mesh, Field attribute) {
  EXPECT_EQ(CheckHas({attribute}, mesh), absl::OkStatus());
  std::vector<uint32_t> numbers;
  AttributeNumbers of_mesh(mesh);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    numbers.push_back(of_mesh.At(t, mesh.triangles[t][0], attribute));
  }
  return numbers;
}

std::string Refusal(Field attribute, const Mesh& mesh) { return std::string(CheckHas({attribute}, mesh).message()); }

constexpr char kObj[] =
    "v 0 0 0 1 0 0\nv 1 0 0 0 0.5 0\nv 0 1 0 0 0 1\nv 0 0 1 1 1 1\n"
    "o nothing\no one\nusemtl wood\nf 1 2 3\nusemtl iron\nf 2 3 4\no two\nf 3 4 1\nusemtl wood\nf 4 1 2\n";

TEST(MeshAttributes, OfObjAreItsObjectsMaterialsAndVertexColors) {
  const Mesh mesh = ParseObj(kObj).value();
  EXPECT_THAT(NumbersOf(mesh, Field::kPart), ElementsAre(0, 0, 1, 1));
  EXPECT_THAT(NumbersOf(mesh, Field::kMaterial), ElementsAre(0, 1, 1, 0));
  EXPECT_THAT(NumbersOf(mesh, Field::kColor), ElementsAre(0xFF0000, 0x008000, 0x0000FF, 0xFFFFFF));
}

TEST(MeshAttributes, ThatSomeOfAnObjLacksAreMissed) {
  const Mesh late = ParseObj("v 0 0 0\nv 1 0 0 1 1 1\nv 0 1 0 1 1 1\nf 1 2 3\nusemtl a\nf 3 2 1\n").value();
  EXPECT_THAT(Refusal(Field::kMaterial, late), HasSubstr("has no material"));
  EXPECT_THAT(NumbersOf(late, Field::kPart), ElementsAre(0, 0));
  // A weight, numbers below 0, and a comment are not colors.
  for (const char* more : {" 1", " -1 0 0", " # 1 1 1", " 1 1", " 1 1 x"}) {
    const std::string v = std::string(more) + "\n";
    const auto mesh = ParseObj("v 0 0 0" + v + "v 1 0 0" + v + "v 0 1 0" + v + "f 1 2 3\n");
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    EXPECT_THAT(Refusal(Field::kColor, *mesh), HasSubstr("has no color")) << more;
  }
}

// Returns a mesh of three vertices with colors between and after their coordinates.
absl::StatusOr<Mesh> ColoredPly(const std::string& type, const std::array<std::string, 3>& names,
                                const std::array<std::string, 3>& first, const std::string& more = "") {
  const auto property = [&](size_t n) { return "property " + type + " " + names[n] + "\n"; };
  return ParsePly("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n" + property(0) +
                  "property float y\nproperty float z\n" + property(1) + property(2) +
                  "element face 1\nproperty list uchar int vertex_indices\n" + more + "end_header\n0 " + first[0] +
                  " 0 0 " + first[1] + " " + first[2] + "\n1 0 0 0 1 0\n0 1 1 0 0 1\n3 0 1 2 9 9 9\n");
}

TEST(MeshAttributes, OfPlyAreColorsAsBytesWhateverTheirType) {
  const std::array<std::string, 3> plain{"red", "green", "blue"},
      diffuse{"diffuse_red", "diffuse_green", "diffuse_blue"};
  for (const auto& names : {plain, diffuse}) {
    const auto mesh = ColoredPly("uchar", names, {"1", "2", "255"});
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    EXPECT_EQ(mesh->positions[1], (Vec3d{1, 0, 0}));
    EXPECT_THAT(mesh->colors, ElementsAre(Color{1, 2, 255}, Color{0, 1, 0}, Color{1, 0, 1}));
    EXPECT_THAT(Refusal(Field::kMaterial, *mesh), EndsWith("has no material"));
    for (const char* type : {"float", "double"}) {
      const auto floats = ColoredPly(type, names, {"0.5", "0.0038", "1.0"});
      ASSERT_TRUE(floats.ok()) << floats.status();
      EXPECT_THAT(floats->colors, ElementsAre(Color{128, 1, 255}, Color{0, 255, 0}, Color{255, 0, 255})) << type;
    }
    EXPECT_EQ(ColoredPly("ushort", names, {"65535", "257", "300"}).value().colors[0], (Color{255, 1, 1}));
  }
}

TEST(MeshAttributes, OfPlyThatAreNoColorsAreMissedForAReason) {
  const auto refusal = [](const std::string& type, const std::array<std::string, 3>& names,
                          const std::array<std::string, 3>& first, const std::string& more = "") {
    const auto mesh = ColoredPly(type, names, first, more);
    return mesh.ok() ? Refusal(Field::kColor, *mesh) : mesh.status().ToString();
  };
  const std::array<std::string, 3> names{"red", "green", "blue"};
  EXPECT_THAT(refusal("float", names, {"0", "128", "0"}),
              HasSubstr("(green 128 of vertex 0 is not within 0 and 1, the range of type float)"));
  EXPECT_THAT(refusal("float", names, {"nan", "1", "0"}),
              HasSubstr("(red nan of vertex 0 is not within 0 and 1, the range of type float)"));
  EXPECT_THAT(refusal("uchar", names, {"-1", "1", "0"}), HasSubstr("(red -1 of vertex 0 is not within 0 and 255"));
  EXPECT_THAT(refusal("int", names, {"0", "0", "0"}),
              HasSubstr("(red of element vertex is int, which is not one of uchar"));
  EXPECT_THAT(refusal("uchar", {"red", "grue", "blue"}, {"0", "0", "0"}), EndsWith("has no color"));
  EXPECT_THAT(refusal("uchar", {"u", "v", "w"}, {"0", "0", "0"},
                      "property float red\nproperty float green\nproperty float blue\n"),
              HasSubstr("(red 9 of face 0 is not within 0 and 1, the range of type float)"));
}

TEST(MeshAttributes, OfNamesThatAreNotUtf8AreText) {
  const auto mesh = ParseObj("v 0 0 0\nv 1 0 0\nv 0 1 0\no caf\xe9\nusemtl \xc3\xa9\xff\nf 1 2 3\n");
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_THAT(mesh->part_names, ElementsAre("caf\uFFFD"));
  EXPECT_THAT(mesh->material_names, ElementsAre("\u00e9\uFFFD"));
}

// Two triangles and a quad on four vertices; the colors stand before and after the corners.
absl::StatusOr<Mesh> PlyOfColoredFaces(const std::string& vertices, const std::string& faces,
                                       const ParseOptions& options = {}) {
  return ParsePly("ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n" +
                      vertices + "element face 3\nproperty uchar red\nproperty list uchar int vertex_indices\n" +
                      "property uchar green\nproperty uchar blue\nend_header\n" +
                      "0 0 0 1 2 3\n1 0 0 1 2 3\n1 1 0 1 2 3\n0 1 0 1 2 3\n" + faces,
                  options);
}

TEST(MeshAttributes, OfPlyMayBeColorsOfFaces) {
  const std::string faces = "255 3 0 1 2 0 0\n0 4 0 1 2 3 128 0\n0 3 2 1 0 0 7\n";
  const auto mesh = PlyOfColoredFaces("property int a\nproperty int b\nproperty int c\n", faces);
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_THAT(NumbersOf(*mesh, Field::kColor), ElementsAre(0xFF0000, 0x008000, 0x008000, 0x000007));
  EXPECT_THAT(mesh->warnings, IsEmpty());
  EXPECT_EQ(mesh->positions[mesh->triangles[3][0]], (Vec3d{1, 1, 0}));
  // Those of vertices count.
  const auto both = PlyOfColoredFaces("property uchar red\nproperty uchar green\nproperty uchar blue\n", faces);
  ASSERT_TRUE(both.ok()) << both.status();
  EXPECT_THAT(NumbersOf(*both, Field::kColor), Each(0x010203));
  ASSERT_EQ(both->warnings.size(), 1u);
  EXPECT_EQ(both->warnings[0].code, "IGNORED_COLOR");
}

TEST(MeshAttributes, OfBrokenFacesOfPlyAreLeftOutWithThem) {
  const std::string more = "property int a\nproperty int b\nproperty int c\n";
  const auto mesh = PlyOfColoredFaces(more, "255 3 0 1 2 0 0\n9 3 0 1 7 9 9\n0 3 2 1 0 0 7\n", {.skip_bad = true});
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_THAT(NumbersOf(*mesh, Field::kColor), ElementsAre(0xFF0000, 0x000007));
}

// Strips have no colors, wherever they stand.
TEST(MeshAttributes, OfPlyWithStripsBesideColoredFacesAreWhiteThere) {
  const std::string strips = "element tristrips 1\nproperty list int int vertex_indices\n",
                    faces =
                        "element face 1\nproperty list int int vertex_indices\nproperty uchar red\n"
                        "property uchar green\nproperty uchar blue\n",
                    head =
                        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                        "property float z\n",
                    vertices = "end_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  for (const bool first : {false, true}) {
    const auto mesh = ParsePly(head + (first ? strips + faces : faces + strips) + vertices +
                               (first ? "3 0 1 2\n3 1 2 3 9 8 7\n" : "3 1 2 3 9 8 7\n3 0 1 2\n"));
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    EXPECT_THAT(NumbersOf(*mesh, Field::kColor),
                first ? ElementsAre(0xFFFFFF, 0x090807) : ElementsAre(0x090807, 0xFFFFFF));
    ASSERT_EQ(mesh->warnings.size(), 1u);
    EXPECT_EQ(mesh->warnings[0].message, "1 of 2 triangles have no color, and are white");
  }
}

TEST(MeshAttributes, OfStlAreItsSolids) {
  const std::string facet = "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet\n";
  const auto mesh = ParseStl("solid a\n" + facet + facet + "endsolid a\nsolid b\n" + facet + "endsolid b\n");
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_THAT(NumbersOf(*mesh, Field::kPart), ElementsAre(0, 0, 1));
}

// Two nodes with one mesh of two primitives, and vertex colors as floats.
TEST(MeshAttributes, OfGltfAreNodesMaterialsAndVertexColors) {
  const std::string buffer =  // (0,0,0) (1,0,0) (0,1,0) as positions; the same as colors
      "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
  const std::string primitive = R"({"attributes": {"POSITION": 0, "COLOR_0": 0}, "material": )";
  const auto mesh = ParseGltf(
      R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}], "materials": [{}, {}],
          "nodes": [{"mesh": 0}, {"mesh": 0, "translation": [5, 0, 0]}], "meshes": [{"primitives": [)" +
          primitive + "1}, " + primitive + R"(0}]}],
          "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
                         "max": [1, 1, 0]}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
          "buffers": [{"byteLength": 36, "uri": ")" +
          buffer + "\"}]}",
      "");
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_THAT(NumbersOf(*mesh, Field::kPart), ElementsAre(0, 0, 1, 1));
  EXPECT_THAT(NumbersOf(*mesh, Field::kMaterial), ElementsAre(0, 1, 0, 1));
  ASSERT_EQ(mesh->colors.size(), mesh->positions.size());
  EXPECT_EQ(mesh->colors[1], (Color{255, 0, 0}));
  EXPECT_EQ(mesh->colors[2], (Color{0, 255, 0}));
}

TEST(MeshAttributes, OfSeveralMeshesAreNumberedOn) {
  const Mesh obj = ParseObj(kObj).value();
  const Mesh plain = ParseObj("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").value();
  Mesh joined;
  for (const Mesh& mesh : {plain, obj, obj}) ASSERT_TRUE(Append(mesh, kIdentity, joined).ok());
  EXPECT_THAT(NumbersOf(joined, Field::kPart), ElementsAre(0, 1, 1, 2, 2, 3, 3, 4, 4));
  EXPECT_THAT(Refusal(Field::kColor, joined), HasSubstr("has no color"));
  EXPECT_THAT(Refusal(Field::kMaterial, joined), HasSubstr("has no material"));
  Mesh both;
  for (const Mesh& mesh : {obj, obj}) ASSERT_TRUE(Append(mesh, kIdentity, both).ok());
  EXPECT_THAT(NumbersOf(both, Field::kMaterial), ElementsAre(0, 1, 1, 0, 2, 3, 3, 2));
  EXPECT_EQ(NumbersOf(both, Field::kColor)[6], 0x0000FFU);
}

// Draco's decoder finds each part with its six corners, and only colors of the mesh.
TEST(EncodedAttributes, EqualThoseOfTheMeshAndSplitNoPointNeedlessly) {
  const Mesh mesh = ParseObj(kObj).value();
  for (const int bits : {0, 14}) {
    const auto encoded = EncodeMesh(mesh, bits, {Field::kColor, Field::kPart, Field::kMaterial});
    ASSERT_TRUE(encoded.ok()) << encoded.status();
    draco::DecoderBuffer buffer;
    buffer.Init(encoded->drc.data(), encoded->drc.size());
    draco::Decoder decoder;
    const auto decoded = std::move(decoder.DecodeMeshFromBuffer(&buffer)).value();
    const int part = decoded->GetAttributeIdByMetadataEntry("name", "part");
    ASSERT_GE(part, 0);
    const draco::PointAttribute& parts = *decoded->attribute(part);
    const draco::PointAttribute& colors = *decoded->GetNamedAttribute(draco::GeometryAttribute::COLOR);
    EXPECT_EQ(parts.attribute_type(), draco::GeometryAttribute::GENERIC);
    EXPECT_EQ(parts.data_type(), draco::DT_UINT32);
    EXPECT_TRUE(colors.normalized());
    std::map<uint32_t, int> corners;
    for (uint32_t f = 0; f < decoded->num_faces(); ++f) {
      for (const draco::PointIndex& point : decoded->face(draco::FaceIndex(f))) {
        uint32_t number = 0;
        parts.GetMappedValue(point, &number);
        ++corners[number];
        Color color;
        colors.GetMappedValue(point, color.data());
        EXPECT_THAT(mesh.colors, testing::Contains(color));
      }
    }
    EXPECT_EQ(corners, (std::map<uint32_t, int>{{0, 6}, {1, 6}}));
    EXPECT_EQ(decoded->num_points(), 12U);  // no two triangles share both part and material
  }
  const auto plain = EncodeMesh(mesh, 0);
  ASSERT_TRUE(plain.ok()) << plain.status();
  EXPECT_EQ(plain->drc, EncodeMesh(ParseObj(kObj).value(), 0, {})->drc);
  EXPECT_LT(plain->drc.size(), EncodeMesh(mesh, 0, {Field::kColor})->drc.size());
}

}  // namespace
}  // namespace latvox::client
