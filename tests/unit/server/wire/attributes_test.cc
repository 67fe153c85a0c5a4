// Fields of the mesh, from the specification and the Draco mesh to the certificate: what is taken, and what is refused.
#include <draco/compression/encode.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "server/base/errors.h"
#include "server/decode/decoder_protocol.h"
#include "server/decode/draco_decoder.h"
#include "server/wire/convert.h"

namespace latvox {
namespace {

using testing::HasSubstr;

// An attribute as a client's encoder may have made it, all vertices' values one after the other.
template <class T>
struct DracoValues {
  draco::GeometryAttribute::Type type;
  int8_t components;
  draco::DataType number;
  std::vector<T> values;
  std::string name;  // in its metadata; empty: none
};

// A tetrahedron.
const TriangleMesh& Tetrahedron() {
  static const auto& mesh =
      *new TriangleMesh{{{0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {0, 0, 8}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  return mesh;
}

template <class... T>
std::string Encode(bool edgebreaker, const DracoValues<T>&... attributes) {
  draco::Mesh out;
  const TriangleMesh& mesh = Tetrahedron();
  out.set_num_points(static_cast<uint32_t>(mesh.vertices.size()));
  const auto add = [&](const auto& added) {
    draco::GeometryAttribute attribute;
    attribute.Init(added.type, nullptr, added.components, added.number, false,
                   added.components * static_cast<int64_t>(sizeof(added.values[0])), 0);
    const int id = out.AddAttribute(attribute, true, out.num_points());
    for (uint32_t p = 0; p < out.num_points(); ++p) {
      out.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(p),
                                           &added.values[p * static_cast<size_t>(added.components)]);
    }
    if (added.name.empty()) return;
    auto metadata = std::make_unique<draco::AttributeMetadata>();
    metadata->AddEntryString("name", added.name);
    out.AddAttributeMetadata(id, std::move(metadata));
  };
  std::vector<float> positions;
  for (const Vec3f& v : mesh.vertices) positions.insert(positions.end(), v.begin(), v.end());
  add(DracoValues<float>{draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32, positions, ""});
  (add(attributes), ...);
  for (const auto& triangle : mesh.triangles) {
    out.AddFace({draco::PointIndex(triangle[0]), draco::PointIndex(triangle[1]), draco::PointIndex(triangle[2])});
  }
  draco::Encoder encoder;
  encoder.SetEncodingMethod(edgebreaker ? draco::MESH_EDGEBREAKER_ENCODING : draco::MESH_SEQUENTIAL_ENCODING);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(out, &buffer).ok());
  return std::string(buffer.data(), buffer.size());
}

constexpr auto kGeneric = draco::GeometryAttribute::GENERIC, kColorType = draco::GeometryAttribute::COLOR;
const DracoValues<int32_t> kParts{kGeneric, 1, draco::DT_INT32, {7, 8, 9, 1000000}, "part"};
const DracoValues<uint8_t> kMaterials{kGeneric, 1, draco::DT_UINT8, {4, 5, 6, 255}, "material"};
const DracoValues<uint8_t> kColors{
    kColorType, 4, draco::DT_UINT8, {1, 2, 3, 9, 4, 5, 6, 9, 0, 0, 0, 9, 255, 255, 255, 9}, ""};

// The numbers of each vertex, by its position.
std::map<Vec3f, std::vector<uint32_t>> NumbersOf(const TriangleMesh& mesh, size_t count) {
  std::map<Vec3f, std::vector<uint32_t>> numbers;
  EXPECT_EQ(mesh.attributes.size(), mesh.vertices.size() * count);
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    const uint32_t* const first = &mesh.attributes[v * count];
    numbers[mesh.vertices[v]] = {first, first + count};
  }
  return numbers;
}

TEST(Attributes, ComeInTheOrderInWhichTheyAreWanted) {
  for (const bool edgebreaker : {false, true}) {
    const auto wanted = FieldList{Field::kColor, Field::kPart, Field::kMaterial};
    const auto decoded = DecodeDraco(Encode(edgebreaker, kMaterials, kColors, kParts), {}, wanted);
    ASSERT_TRUE(decoded.ok()) << decoded.status();
    const auto numbers = NumbersOf(decoded->mesh, 3);
    EXPECT_EQ(numbers.at({0, 0, 0}), (std::vector<uint32_t>{0x010203, 7, 4}));
    EXPECT_EQ(numbers.at({8, 0, 0}), (std::vector<uint32_t>{0x040506, 8, 5}));
    EXPECT_EQ(numbers.at({0, 0, 8}), (std::vector<uint32_t>{0xFFFFFF, 1000000, 255}));
    EXPECT_TRUE(DecodeDraco(Encode(edgebreaker, kParts), {})->mesh.attributes.empty());
  }
}

TEST(Attributes, ColorsMayBeOfOtherNumbers) {
  const auto wanted = FieldList{Field::kColor};
  const DracoValues<uint16_t> wide{kColorType, 3, draco::DT_UINT16, {0, 257, 65535, 0, 0, 128, 0, 0, 129, 0, 0, 0}, ""};
  const auto of_wide = DecodeDraco(Encode(false, wide), {}, wanted);
  ASSERT_TRUE(of_wide.ok()) << of_wide.status();
  EXPECT_EQ(of_wide->mesh.attributes, (std::vector<uint32_t>{0x0001FF, 0, 1, 0}));
  const DracoValues<float> real{kColorType, 3, draco::DT_FLOAT32, {0, 0.5F, 1, 0, 0, 0, 1, 1, 1, 0.3F, 0, 0}, ""};
  const auto of_real = DecodeDraco(Encode(false, real), {}, wanted);
  ASSERT_TRUE(of_real.ok()) << of_real.status();
  EXPECT_EQ(of_real->mesh.attributes, (std::vector<uint32_t>{0x0080FF, 0, 0xFFFFFF, 0x4D0000}));
}

template <class... T>
void ExpectRefused(Field kind, const char* says, const DracoValues<T>&... attributes) {
  const absl::Status status = DecodeDraco(Encode(false, attributes...), {}, FieldList{kind}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << says;
  EXPECT_THAT(std::string(status.message()), HasSubstr(says));
  EXPECT_EQ(CauseOf(status)->field, "fields");
  EXPECT_EQ(CauseOf(status)->value, NameOf(kind));
  EXPECT_EQ(DecodeError(EncodeError(status)).message(), status.message());  // as the server gets it
}

TEST(Attributes, ThatAMeshLacksOrHasWrongAreRefusedByName) {
  const auto part = Field::kPart, color = Field::kColor;
  ExpectRefused(part, "fields: the mesh has no part", kMaterials);
  ExpectRefused(color, "fields: the mesh has no color", kParts);
  ExpectRefused(part, "the mesh has no part",
                DracoValues<uint8_t>{kColorType, 1, draco::DT_UINT8, {1, 2, 3, 4}, "part"});
  ExpectRefused(part, "part has 2 components, not 1",
                DracoValues<uint8_t>{kGeneric, 2, draco::DT_UINT8, {1, 2, 3, 4, 5, 6, 7, 8}, "part"});
  ExpectRefused(part, "part holds no integers",
                DracoValues<float>{kGeneric, 1, draco::DT_FLOAT32, {1, 2, 3, 4}, "part"});
  ExpectRefused(part, "is not within 0 and 2147483647",
                DracoValues<int32_t>{kGeneric, 1, draco::DT_INT32, {1, 2, -3, 4}, "part"});
  ExpectRefused(color, "color has 2 components, not 3 or more",
                DracoValues<uint8_t>{kColorType, 2, draco::DT_UINT8, {1, 2, 3, 4, 5, 6, 7, 8}, ""});
  ExpectRefused(color, "neither unsigned integers nor 32-bit floats",
                DracoValues<int8_t>{kColorType, 3, draco::DT_INT8, {1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 2, 3}, ""});
  for (const float bad : {1.5F, -0.5F, std::nanf("")}) {
    ExpectRefused(color, "is not within 0 and 1",
                  DracoValues<float>{kColorType, 3, draco::DT_FLOAT32, {1, 1, 1, 1, 1, bad, 1, 1, 1, 1, 1, 1}, ""});
  }
}

TEST(Attributes, AreRefusedInASpecificationThatCannotHaveThem) {
  const auto refusal = [](const auto& spoil) {
    v1::VoxelizeSpec spec;
    spec.mutable_lattice()->set_named(v1::NAMED_LATTICE_BCC);
    spec.set_resolution(9);
    spec.add_fields(v1::FIELD_PART);
    EXPECT_EQ(JobSpecFromProto(spec, {})->request.fields, FieldList{Field::kPart});
    spoil(spec);
    const absl::Status status = JobSpecFromProto(spec, {}).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_EQ(CauseOf(status)->field, "fields");
    return std::string(status.message());
  };
  EXPECT_EQ(refusal([](auto& s) { s.add_fields(v1::FIELD_PART); }), "fields: part stands twice");
  EXPECT_EQ(refusal([](auto& s) { s.add_fields(v1::FIELD_UNSPECIFIED); }), "fields 0 is not a field");
  EXPECT_EQ(refusal([](auto& s) { s.add_fields(static_cast<v1::Field>(99)); }), "fields 99 is not a field");
  EXPECT_THAT(refusal([](auto& s) { s.set_algorithm(v1::ALGORITHM_INCREMENTAL); }), HasSubstr("incremental"));
}

// A decoder process may send anything.
TEST(Attributes, OfAReceiverAreAsManyAndAsLargeAsTheyMayBe) {
  using Progress = MeshReceiver::Progress;
  const auto bytes = [](const auto& elements) {
    return absl::string_view(reinterpret_cast<const char*>(elements.data()), elements.size() * sizeof(elements[0]));
  };
  const TriangleMesh& mesh = Tetrahedron();
  const MeshFrame head{4, 4, 0};
  const auto take = [&](const std::vector<uint32_t>& numbers, const FieldList& wanted) {
    MeshReceiver receiver({}, {}, wanted);
    receiver.Receive(FrameKind::kMesh, {reinterpret_cast<const char*>(&head), sizeof(head)});
    receiver.Receive(FrameKind::kVertices, bytes(mesh.vertices));
    receiver.Receive(FrameKind::kTriangles, bytes(mesh.triangles));
    const Progress progress = receiver.Receive(FrameKind::kAttributes, bytes(numbers));
    return progress == Progress::kMore ? receiver.Receive(FrameKind::kDone, "") : progress;
  };
  const auto both = FieldList{Field::kPart, Field::kColor};
  EXPECT_EQ(take({0x7FFFFFFF, 0xFFFFFF, 1, 2, 3, 4, 5, 6}, both), Progress::kDone);
  EXPECT_EQ(take({0x80000000, 0xFFFFFF, 1, 2, 3, 4, 5, 6}, both), Progress::kBroken);
  EXPECT_EQ(take({1, 0x1000000, 1, 2, 3, 4, 5, 6}, both), Progress::kBroken);
  EXPECT_EQ(take({1, 2, 3, 4, 5, 6, 7}, both), Progress::kBroken);
  EXPECT_EQ(take({1, 2, 3, 4, 5, 6, 7, 8, 9}, both), Progress::kBroken);
  EXPECT_EQ(take({}, {}), Progress::kDone);
  EXPECT_EQ(take({1}, {}), Progress::kBroken);
}

}  // namespace
}  // namespace latvox
