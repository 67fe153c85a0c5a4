// Meshes as plain arrays: their numbers, and refusals while they arrive.
#include "server/decode/raw_mesh.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "server/base/errors.h"

namespace latvox {
namespace {

using testing::HasSubstr;

template <class T>
std::string BytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

const std::vector<double> kPositions = {691603.5, 0.1, 0, 1, 0, 0, 0, 1, -1e300, 4, 5, 6};
const std::vector<uint32_t> kTriangles = {0, 1, 2, 3, 2, 1}, kParts = {7, 8, 9, 0x7FFFFFFF},
                            kColors = {0, 0xFFFFFF, 0x10203, 4};
const RawMeshLayout kLayout{4, 2, true, {Field::kPart, Field::kColor}};

std::string Bytes() { return BytesOf(kPositions) + BytesOf(kTriangles) + BytesOf(kParts) + BytesOf(kColors); }

// Checks the bytes in pieces of a size.
absl::Status Check(const std::string& bytes, size_t size, const RawMeshLayout& layout = kLayout) {
  RawMeshCheck check(layout);
  for (size_t at = 0; at < bytes.size(); at += size) {
    if (absl::Status status = check.Add(absl::string_view(bytes).substr(at, size)); !status.ok()) return status;
  }
  return absl::OkStatus();
}

TEST(RawMesh, ArraysAreReadWithTheWantedAttributesInTheirOrder) {
  absl::Cord cord;
  const std::string bytes = Bytes();
  for (size_t at = 0; at < bytes.size(); at += 7) cord.Append(bytes.substr(at, 7));
  const auto mesh = ReadRawMesh(cord, kLayout, {Field::kColor, Field::kPart});
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_TRUE(mesh->vertices.empty());
  ASSERT_EQ(mesh->double_vertices.size(), 4u);
  EXPECT_EQ(mesh->double_vertices[0], (Vec3d{691603.5, 0.1, 0}));
  EXPECT_EQ(mesh->double_vertices[2], (Vec3d{0, 1, -1e300}));
  EXPECT_THAT(mesh->triangles,
              testing::ElementsAre(std::array<uint32_t, 3>{0, 1, 2}, std::array<uint32_t, 3>{3, 2, 1}));
  EXPECT_THAT(mesh->attributes, testing::ElementsAre(0, 7, 0xFFFFFF, 8, 0x10203, 9, 4, 0x7FFFFFFF));
}

TEST(RawMesh, ACancelledReadIsNoMesh) {
  StopSource stop;
  EXPECT_TRUE(ReadRawMesh(absl::Cord(Bytes()), kLayout, {Field::kPart}, stop.Signal()).ok());
  stop.Stop();
  EXPECT_EQ(ReadRawMesh(absl::Cord(Bytes()), kLayout, {Field::kPart}, stop.Signal()).status().code(),
            absl::StatusCode::kCancelled);
}

// Copies are made piece by piece.
TEST(RawMesh, ArraysOfManyPiecesAreRead) {
  constexpr uint32_t kVertices = 300001;
  std::vector<float> positions(3 * kVertices);
  std::vector<uint32_t> corners, parts(kVertices), colors(kVertices);
  for (uint32_t n = 0; n < kVertices; ++n) {
    positions[3 * n + 1] = static_cast<float>(n);
    corners.insert(corners.end(), {n, kVertices - 1 - n, n / 2});
    parts[n] = 5 * n;
    colors[n] = n;
  }
  const std::string bytes = BytesOf(positions) + BytesOf(corners) + BytesOf(parts) + BytesOf(colors);
  const RawMeshLayout layout{kVertices, kVertices, false, {Field::kPart, Field::kColor}};
  const auto mesh = ReadRawMesh(absl::Cord(bytes), layout, {Field::kColor, Field::kPart});
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  ASSERT_EQ(mesh->vertices.size(), kVertices);
  ASSERT_EQ(mesh->triangles.size(), kVertices);
  ASSERT_EQ(mesh->attributes.size(), 2 * kVertices);
  for (uint32_t n = 0; n < kVertices; ++n) {
    ASSERT_EQ(mesh->vertices[n], (Vec3f{0, static_cast<float>(n), 0}));
    ASSERT_EQ(mesh->triangles[n], (std::array<uint32_t, 3>{n, kVertices - 1 - n, n / 2}));
    ASSERT_EQ(mesh->attributes[2 * n], n);
    ASSERT_EQ(mesh->attributes[2 * n + 1], 5 * n);
  }
}

TEST(RawMesh, FloatsStayFloats) {
  const RawMeshLayout layout{3, 1, false, {}};
  const std::string bytes = BytesOf<float>({0, 0.1F, 0, 1, 0, 0, 0, 1, 0}) + BytesOf<uint32_t>({0, 1, 2});
  const auto mesh = ReadRawMesh(absl::Cord(bytes), layout, {});
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ(mesh->vertices[0], (Vec3f{0, 0.1F, 0}));
  EXPECT_TRUE(mesh->double_vertices.empty() && mesh->attributes.empty());
}

TEST(RawMesh, ABadNumberIsNamedAsSoonAsItHasCome) {
  const size_t triangles = 12 * 8, parts = triangles + 6 * 4, colors = parts + 4 * 4;
  struct Case {
    size_t at;
    std::string number;
    const char* message;
  };
  const std::vector<Case> cases = {
      {8, BytesOf<double>({std::numeric_limits<double>::infinity()}), "mesh: vertex 0 is not finite"},
      {72, BytesOf<double>({std::nan("")}), "mesh: vertex 3 is not finite"},
      {triangles + 20, BytesOf<uint32_t>({4}), "mesh: triangle 1 uses vertex 4 of 4"},
      {parts + 4, BytesOf<uint32_t>({0x80000000}),
       "mesh: the part of vertex 1, 2147483648, is not within 0 and 2147483647"},
      {colors + 12, BytesOf<uint32_t>({0x1000000}),
       "mesh: the color of vertex 3, 16777216, is not within 0 and 16777215"}};
  for (const auto& [at, number, message] : cases) {
    std::string bytes = Bytes();
    bytes.replace(at, number.size(), number);
    for (const size_t size : {1, 3, 8, 1000}) {
      const absl::Status status = Check(bytes, size);
      EXPECT_EQ(status.message(), message) << size;
      EXPECT_EQ(CauseOf(status)->reason, "BAD_MESH");
      EXPECT_TRUE(Check(bytes.substr(0, at + number.size() - 1), size).ok()) << message;
      EXPECT_FALSE(Check(bytes.substr(0, at + number.size()), size).ok()) << message;
    }
    // Bytes that were stored before anybody knew their layout are checked when they are read.
    EXPECT_EQ(ReadRawMesh(absl::Cord(bytes), kLayout, {Field::kPart, Field::kColor}).status().code(),
              absl::StatusCode::kInvalidArgument)
        << message;
  }
  EXPECT_TRUE(Check(Bytes() + "more", 5).ok());  // the length is checked elsewhere
}

TEST(RawMesh, AnIndexOfAMeshWithoutVerticesIsRefused) {
  const RawMeshLayout none{0, 1, false, {Field::kPart}};
  EXPECT_EQ(Check(BytesOf<uint32_t>({0, 1, 2}), 12, none).message(), "mesh: triangle 0 uses vertex 0 of 0");
}

TEST(RawMesh, RefusalsNameTheLengthAndTheAttribute) {
  EXPECT_THAT(ReadRawMesh(absl::Cord(Bytes() + "x"), kLayout, {}).status().message(),
              HasSubstr("raw_mesh describes 152 bytes, but the mesh has 153"));
  const absl::Status lacks = ReadRawMesh(absl::Cord(Bytes()), kLayout, {Field::kMaterial}).status();
  EXPECT_EQ(lacks.message(), "fields: the mesh has no material");
  EXPECT_EQ(CauseOf(lacks)->field, "fields");
}

}  // namespace
}  // namespace latvox
