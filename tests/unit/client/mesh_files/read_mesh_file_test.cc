#include "latvox/mesh_files/read_mesh_file.h"

#include <gmock/gmock.h>

#include <array>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "client/internal/printable.h"
#include "client/mesh/mesh_encoder.h"
#include "client/mesh_files/mesh_file.h"
#include "client/mesh_files/mesh_format.h"
#include "latvox/mesh/encode_mesh.h"
#include "tests/unit/client/files.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Two objects, two materials in turn, a color at each vertex, and a line.
constexpr char kObj[] =
    "v 1 2 3 1 0 0\nv 1.5 2 3 0 1 0\nv 1 2.5 3 0 0 1\nl 1 2\n"
    "o a\nusemtl m\nf 1 2 3\nusemtl n\nf 1 3 2\no b\nusemtl m\nf 2 3 1\n";

class MeshFile : public FilesTest {
 protected:
  TriangleMesh Colored() const { return ReadMeshFile(Write("colored.obj", kObj)).value(); }
};

TEST_F(MeshFile, IsPositionsTrianglesAndOneNumberForEach) {
  const TriangleMesh mesh = Colored();
  EXPECT_THAT(mesh.positions, ElementsAre(Vec3d{1, 2, 3}, Vec3d{1.5, 2, 3}, Vec3d{1, 2.5, 3}));
  using Triangle = std::array<uint32_t, 3>;
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 1}, Triangle{1, 2, 0}));
  EXPECT_THAT(mesh.parts, ElementsAre(0, 0, 1));
  EXPECT_THAT(mesh.materials, ElementsAre(0, 1, 0));
  EXPECT_THAT(mesh.colors, ElementsAre(Color{255, 0, 0}, Color{0, 255, 0}, Color{0, 0, 255}));
  EXPECT_EQ(mesh.skipped, 1U);
}

TEST_F(MeshFile, WithoutAttributesHasEmptyLists) {
  const auto mesh = ReadMeshFile(Write("plain.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 4 3\n"));
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ(mesh->triangles.size(), 2U);
  EXPECT_THAT(mesh->parts, IsEmpty());
  EXPECT_THAT(mesh->materials, IsEmpty());
  EXPECT_THAT(mesh->colors, IsEmpty());
  EXPECT_THAT(mesh->warnings, IsEmpty());
}

TEST_F(MeshFile, OfElementsWithoutASurfaceMakesAWarningInEveryFormat) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement edge 2\n"
      "property int vertex1\nproperty int vertex2\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n0 1\n1 2\n3 0 1 2\n";
  const auto mesh = ReadMeshFile(Write("edges.ply", ply));
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ(mesh->skipped, 2U);
  ASSERT_EQ(mesh->warnings.size(), 1U);
  EXPECT_EQ(mesh->warnings[0].code, "SKIPPED_ELEMENTS");
  EXPECT_THAT(mesh->warnings[0].message, HasSubstr("2 elements without a surface are left out"));
  const auto obj = ReadMeshFile(Write("line.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\nf 1 2 3\n"));
  ASSERT_EQ(obj->warnings.size(), 1U);
  EXPECT_EQ(obj->warnings[0].code, "SKIPPED_ELEMENTS");
}

TEST_F(MeshFile, IsTurnedThenScaled) {
  const std::string path = Write("m.obj", kObj);
  EXPECT_EQ(ReadMeshFile(path, {.up = UpAxis::kY, .scale = 2})->positions[0], (Vec3d{2, -6, 4}));
  EXPECT_EQ(ReadMeshFile(path, {.up = UpAxis::kX})->positions[0], (Vec3d{-3, 2, 1}));
  EXPECT_THAT(ReadMeshFile(path, {.scale = 1e308}).status().message(), HasSubstr("m.obj: vertex 0 (1 2 3)"));
}

TEST_F(MeshFile, OfAnotherNameIsReadByItsFormat) {
  const std::string path = Write("mesh.txt", kObj);
  EXPECT_EQ(ReadMeshFile(path).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(ReadMeshFile(path, {.format = MeshFormat::kObj})->triangles.size(), 3U);
}

TEST_F(MeshFile, OfDracoIsDecoded) {
  const std::string drc = EncodeMesh(Colored()).value();
  const auto mesh = ReadMeshFile(Write("m.drc", drc));
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ(mesh->triangles.size(), 3U);
  EXPECT_THAT(std::set(mesh->positions.begin(), mesh->positions.end()),
              testing::UnorderedElementsAreArray(Colored().positions));
}

TEST_F(MeshFile, ThatIsMissingOrDamagedIsNamed) {
  const absl::Status missing = ReadMeshFile(Path("missing.ply")).status();
  EXPECT_EQ(missing.code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(missing.message(), Path("missing.ply") + ": no such file");
  const absl::Status damaged = ReadMeshFile(Write("bad.obj", "v 0 0\n")).status();
  EXPECT_EQ(damaged.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(damaged.message()), HasSubstr(Path("bad.obj") + ": line 1"));
}

TEST_F(MeshFile, OfGarbageIsRefusedInPrintableWords) {
  const std::string garbage("\x01\x1b[2J\xff \0\r", 9);
  const std::string zip("PK\x03\x04", 4);
  const std::string heads[] = {"",
                               "v ",
                               "v 1 2 3\nf ",
                               "ply\nformat ",
                               "ply\nformat ascii 1.0\nelement ",
                               "solid a\nfacet ",
                               "glTF",
                               R"({"asset": {"version": ")",
                               R"({"asset": )",
                               zip,
                               "DRACO"};
  for (const auto& [extension, format] : MeshFormats()) {
    for (const std::string& head : heads) {
      const absl::Status status = ReadMeshFile(Write("\x1b." + extension, head + garbage)).status();
      EXPECT_FALSE(status.ok()) << extension;
      EXPECT_EQ(status.ToString(), Printable(status.ToString())) << extension;
      EXPECT_THAT(std::string(status.message()), HasSubstr("/\\x1b." + extension));
    }
  }
}

TEST_F(MeshFile, IsEncodedWithItsAttributesAsTheToolEncodesIt) {
  const Mesh read = ReadMesh(Write("same.obj", kObj)).value();
  const std::vector<Field> attributes{Field::kColor, Field::kMaterial, Field::kPart};
  for (const int bits : {0, 12}) {
    EXPECT_EQ(EncodeMesh(Colored(), {.quantization_bits = bits}).value(), EncodeMesh(read, bits)->drc);
    EXPECT_EQ(EncodeMesh(Colored(), {attributes, bits}).value(), EncodeMesh(read, bits, attributes)->drc);
  }
}

TEST_F(MeshFile, ThatAProgramChangedWronglyIsRefused) {
  const auto refusal = [&](void (*change)(TriangleMesh&), const EncodeOptions& options = {}) {
    TriangleMesh mesh = Colored();
    change(mesh);
    const absl::Status status = EncodeMesh(mesh, options).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    return std::string(status.message());
  };
  EXPECT_EQ(refusal([](TriangleMesh& m) { m.positions[1][2] = 1e39; }), "positions[1]: 1e+39 exceeds float32");
  EXPECT_EQ(refusal([](TriangleMesh& m) { m.positions[0][0] = std::numeric_limits<double>::infinity(); }),
            "positions[0]: inf is not finite");
  EXPECT_EQ(refusal([](TriangleMesh& m) { m.triangles[2][0] = 3; }),
            "triangles[2]: index 3 is not below 3, the positions");
  EXPECT_EQ(refusal([](TriangleMesh& m) { m.parts.pop_back(); }), "parts: 2 values for 3 triangles");
  EXPECT_EQ(refusal([](TriangleMesh& m) { m.parts = {0, 2, 1}; }), "parts[2]: 1 is below 2, the part before");
  EXPECT_EQ(refusal([](TriangleMesh& m) { m.materials.push_back(7); }), "materials: 4 values for 3 triangles");
  EXPECT_EQ(refusal([](TriangleMesh& m) { m.colors.pop_back(); }), "colors: 2 values for 3 positions");
  EXPECT_THAT(refusal([](TriangleMesh& m) { m.colors.clear(); }, {.fields = {Field::kColor}}),
              HasSubstr("has no color"));
  EXPECT_EQ(refusal([](TriangleMesh&) {}, {.fields = {Field::kPart, Field::kPart}}), "fields: part is named twice");
  EXPECT_EQ(refusal([](TriangleMesh&) {}, {.quantization_bits = 31}), "quantization_bits: 31 is not within 0 to 30");
}

}  // namespace
}  // namespace latvox::client
