#include <draco/compression/decode.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "client/mesh/mesh_encoder.h"
#include "client/mesh/raw_mesh.h"
#include "latvox/mesh/encode_mesh.h"

namespace latvox::client {
namespace {

using Vec3f = std::array<float, 3>;
using Corners = std::array<Vec3d, 3>;

Corners Turned(Corners corners) {
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}

std::multiset<Corners> Triangles(const Mesh& mesh) {
  std::multiset<Corners> out;
  for (const auto& t : mesh.triangles) {
    out.insert(Turned({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]}));
  }
  return out;
}

Mesh Decode(const EncodedMesh& encoded) {
  draco::DecoderBuffer buffer;
  buffer.Init(encoded.drc.data(), encoded.drc.size());
  draco::Decoder decoder;
  const auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
  Mesh mesh;
  if (!decoded.ok()) return mesh;
  const draco::Mesh& from = *decoded.value();
  const draco::PointAttribute* positions = from.GetNamedAttribute(draco::GeometryAttribute::POSITION);
  for (uint32_t n = 0; n < from.num_points(); ++n) {
    Vec3f p;
    positions->GetMappedValue(draco::PointIndex(n), p.data());
    mesh.positions.push_back({p[0], p[1], p[2]});
  }
  for (uint32_t n = 0; n < from.num_faces(); ++n) {
    const auto& face = from.face(draco::FaceIndex(n));
    mesh.triangles.push_back({face[0].value(), face[1].value(), face[2].value()});
  }
  return mesh;
}

// A bent sheet of 2 * side^2 triangles.
Mesh Sheet(uint32_t side) {
  Mesh mesh;
  for (uint32_t y = 0; y <= side; ++y) {
    for (uint32_t x = 0; x <= side; ++x) {
      const float u = static_cast<float>(x) / 7, v = static_cast<float>(y) / 7;
      mesh.positions.push_back({u, v, std::sin(u) * std::cos(v)});
    }
  }
  for (uint32_t y = 0; y < side; ++y) {
    for (uint32_t x = 0; x < side; ++x) {
      const uint32_t corner = y * (side + 1) + x;
      mesh.triangles.push_back({corner, corner + 1, corner + side + 1});
      mesh.triangles.push_back({corner + 1, corner + side + 2, corner + side + 1});
    }
  }
  return mesh;
}

// Triangles between a few random vertices: edges of many triangles, duplicates, both orientations, equal corners.
Mesh Tangle(uint32_t seed) {
  std::mt19937 random(seed);
  const auto below = [&random](uint32_t n) { return std::uniform_int_distribution<uint32_t>(0, n - 1)(random); };
  Mesh mesh;
  const uint32_t vertices = 3 + below(6);
  for (uint32_t n = 0; n < vertices; ++n) {
    mesh.positions.push_back(
        {static_cast<float>(below(3)), static_cast<float>(below(3)), static_cast<float>(below(3)) * 0.1F});
  }
  for (uint32_t n = 0, count = 1 + below(20); n < count; ++n) {
    mesh.triangles.push_back({below(vertices), below(vertices), below(vertices)});
  }
  return mesh;
}

TEST(MeshEncoder, LosslessRoundTripKeepsEveryTriangleBitByBit) {
  const Mesh mesh = Sheet(40);
  const auto encoded = EncodeMesh(mesh, 0);
  ASSERT_TRUE(encoded.ok()) << encoded.status();
  EXPECT_TRUE(encoded->edgebreaker);
  EXPECT_EQ(Triangles(Decode(*encoded)), Triangles(mesh));
}

TEST(MeshEncoder, KeepsEveryTriangleOfNonManifoldDegenerateAndDuplicateOnes) {
  for (uint32_t seed = 0; seed < 500; ++seed) {
    const Mesh mesh = Tangle(seed);
    const auto encoded = EncodeMesh(mesh, 0);
    ASSERT_TRUE(encoded.ok()) << seed << encoded.status();
    ASSERT_EQ(Triangles(Decode(*encoded)), Triangles(mesh)) << seed;
    const auto quantized = EncodeMesh(mesh, 11);
    ASSERT_TRUE(quantized.ok()) << seed << quantized.status();
    ASSERT_EQ(Decode(*quantized).triangles.size(), mesh.triangles.size()) << seed;
  }
}

TEST(MeshEncoder, QuantizationMovesNoVertexByMoreThanHalfAStep) {
  const Mesh mesh = Sheet(20);
  for (const int bits : {1, 8, 11, 16, 24, 30}) {
    const auto encoded = EncodeMesh(mesh, bits);
    ASSERT_TRUE(encoded.ok()) << bits << encoded.status();
    EXPECT_EQ(encoded->quantization_bits, bits);
    const Mesh decoded = Decode(*encoded);
    ASSERT_EQ(decoded.triangles.size(), mesh.triangles.size());
    const double step = LongestSide(mesh) / (std::pow(2., bits) - 1);
    const double bound = step * 0.5001 + LongestSide(mesh) * std::numeric_limits<float>::epsilon();
    for (const Vec3d& p : decoded.positions) {
      const bool near = std::any_of(mesh.positions.begin(), mesh.positions.end(), [&](const Vec3d& q) {
        return std::abs(p[0] - q[0]) <= bound && std::abs(p[1] - q[1]) <= bound && std::abs(p[2] - q[2]) <= bound;
      });
      EXPECT_TRUE(near) << bits;
    }
  }
}

TEST(MeshEncoder, JoinsEqualVerticesAndLeavesOutUnusedOnes) {
  const Mesh soup = {
      {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{1, 2, 3}, {4, 5, 6}}, 0};
  const auto encoded = EncodeMesh(soup, 0);
  ASSERT_TRUE(encoded.ok());
  EXPECT_EQ(Decode(*encoded).positions.size(), 4u);
}

TEST(MeshEncoder, RefusesAnExtentBeyondFloat) {
  const float big = std::numeric_limits<float>::max();
  const Mesh mesh = {{{-big, 0, 0}, {big, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, 0};
  EXPECT_EQ(EncodeMesh(mesh, 11).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(EncodeMesh(Mesh{}, 11).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(EncodeMesh, IsTheEncoderForPlainArraysAndNamesWhatIsWrong) {
  const std::vector<Vec3f> positions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<std::array<uint32_t, 3>> triangles = {{0, 1, 2}, {1, 0, 2}};
  const auto drc = EncodeMesh(positions, triangles);
  ASSERT_TRUE(drc.ok()) << drc.status();
  const Mesh mesh = {.positions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .triangles = triangles};
  EXPECT_EQ(*drc, EncodeMesh(mesh, 0)->drc);
  EXPECT_EQ(EncodeMesh(positions, triangles, 9)->size(), EncodeMesh(mesh, 9)->drc.size());
  const std::vector<Vec3f> infinite = {{1, 0, 0}, {0, INFINITY, 0}, {0, 0, 1}};
  const std::vector<std::pair<absl::Status, const char*>> refusals = {
      {EncodeMesh(positions, {}).status(), "the mesh has no triangles"},
      {EncodeMesh(positions, triangles, 31).status(), "quantization_bits: 31 is not within 0 to 30"},
      {EncodeMesh(infinite, triangles).status(), "positions[1]: inf is not finite"},
      {EncodeMesh({positions.data(), 2}, triangles).status(), "triangles[0]: index 2 is not below 2, the positions"}};
  for (const auto& [status, message] : refusals) EXPECT_EQ(status, absl::InvalidArgumentError(message));
}

TEST(EncodeRawMesh, ArraysAreFloatsWhereTheyAreExactAndDoublesElsewhere) {
  TriangleMesh mesh{{{1, 0, 0}, {0, 1, 0}, {0, 0, 0.5}}, {{0, 1, 2}, {1, 0, 2}}};
  const auto floats = EncodeRawMesh(mesh);
  ASSERT_TRUE(floats.ok()) << floats.status();
  EXPECT_EQ(floats->layout, (RawMeshLayout{3, 2, false, {}}));
  EXPECT_EQ(floats->bytes.size(), 3 * 12 + 2 * 12u);
  mesh.positions[0][0] = 0.1;
  EXPECT_EQ(EncodeRawMesh(mesh)->layout, (RawMeshLayout{3, 2, true, {}}));
  EXPECT_EQ(EncodeRawMesh(mesh)->bytes.size(), 3 * 24 + 2 * 12u);
}

TEST(EncodeRawMesh, AVertexOfTwoPartsBecomesTwo) {
  const TriangleMesh mesh{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}, {1, 0, 2}}, /*parts=*/{3, 5}};
  const auto raw = EncodeRawMesh(mesh, {Field::kPart});
  ASSERT_TRUE(raw.ok()) << raw.status();
  EXPECT_EQ(raw->layout, (RawMeshLayout{6, 2, false, {Field::kPart}}));
  std::array<uint32_t, 12> numbers;  // two triangles, six parts
  std::memcpy(numbers.data(), raw->bytes.data() + 6 * 12, sizeof(numbers));
  EXPECT_EQ(numbers, (std::array<uint32_t, 12>{0, 1, 2, 3, 4, 5, 3, 3, 3, 5, 5, 5}));
}

TEST(EncodeRawMesh, NamesWhatIsWrong) {
  const auto refusal = [](const TriangleMesh& mesh, const std::vector<Field>& attributes) {
    return std::string(EncodeRawMesh(mesh, attributes).status().message());
  };
  const TriangleMesh good{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}}};
  EXPECT_EQ(refusal({good.positions, {}}, {}), "the mesh has no triangles");
  EXPECT_EQ(refusal({good.positions, {{0, 1, 3}}}, {}), "triangles[0]: index 3 is not below 3, the positions");
  EXPECT_EQ(refusal({{{1, 0, 0}, {0, NAN, 0}, {0, 0, 1}}, {{0, 1, 2}}}, {}), "positions[1]: nan is not finite");
  EXPECT_EQ(refusal(good, {Field::kColor}), "the mesh, or some of it, has no color");
  EXPECT_EQ(refusal({{{1e300, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2}}}, {}), "");
}

TEST(RawMesh, DoublesAreNeededWhereFloatsAreCoarserThanTheQuantization) {
  const auto mesh_at = [](double x) { return Mesh{{{x, 0, 0}, {x + 1.1, 0, 0}, {x, 1, 0}}, {{0, 1, 2}}}; };
  EXPECT_FALSE(NeedsDoubles(mesh_at(0), 16));
  EXPECT_TRUE(NeedsDoubles(mesh_at(0), 0));
  EXPECT_TRUE(NeedsDoubles(mesh_at(1000), 16));
  EXPECT_FALSE(NeedsDoubles({{{1e6, 0, 0}, {1e6 + 1, 0, 0}, {1e6, 1, 0}}, {{0, 1, 2}}}, 0));  // float32 holds these
}

TEST(MeshEncoder, AutoBitsGiveStepsOfAtMostOneSnappingStep) {
  EXPECT_EQ(AutoQuantizationBits(2), 11);  // clamped
  EXPECT_EQ(AutoQuantizationBits(128), 16);
  EXPECT_EQ(AutoQuantizationBits(129), 17);
  EXPECT_EQ(AutoQuantizationBits(65536), 25);
  EXPECT_EQ(AutoQuantizationBits(1e30), 30);
  EXPECT_EQ(AutoQuantizationBits(std::numeric_limits<double>::infinity()), 30);
  EXPECT_EQ(AutoQuantizationBits(std::nan("")), 30);
}

}  // namespace
}  // namespace latvox::client
