// Foreign bytes: what DecodeDraco accepts, and how it refuses the rest.
#include <draco/compression/decode.h>
#include <draco/core/encoder_buffer.h>
#include <draco/core/varint_encoding.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "server/decode/draco_decoder.h"
#include "server/decode/draco_header.h"
#include "tests/unit/server/meshes.h"

namespace latvox {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr DracoMethod kMethods[] = {DracoMethod::kSequential, DracoMethod::kEdgebreaker};
constexpr size_t kHeaderBytes = 11;

absl::StatusOr<DecodedMesh> Decode(absl::string_view bytes, const Limits& limits = {}) {
  return DecodeDraco(bytes, limits);
}

// Positions as Draco gives them out by itself, without any option.
PaddedVector<Vec3f> PositionsByDraco(const std::string& bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  const auto mesh = draco::Decoder().DecodeMeshFromBuffer(&buffer).value();
  const auto* attribute = mesh->GetNamedAttribute(draco::GeometryAttribute::POSITION);
  PaddedVector<Vec3f> positions(mesh->num_points());
  for (uint32_t p = 0; p < mesh->num_points(); ++p) {
    attribute->GetMappedValue(draco::PointIndex(p), positions[p].data());
  }
  return positions;
}

// The corners' positions of every triangle, whatever the order of triangles and the numbers of vertices.
std::vector<std::array<Vec3f, 3>> TriangleSoup(const TriangleMesh& mesh) {
  std::vector<std::array<Vec3f, 3>> soup;
  for (const auto& [a, b, c] : mesh.triangles) {
    std::array<Vec3f, 3> corners = {mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    soup.push_back(corners);
  }
  std::sort(soup.begin(), soup.end());
  return soup;
}

// The properties of a status, whatever the bytes.
void ExpectClean(const absl::StatusOr<DecodedMesh>& result) {
  if (result.ok()) {
    EXPECT_TRUE(CheckMesh(result->mesh).ok()) << CheckMesh(result->mesh);
    return;
  }
  EXPECT_TRUE(result.status().code() == absl::StatusCode::kInvalidArgument ||
              result.status().code() == absl::StatusCode::kResourceExhausted)
      << result.status();
  EXPECT_THAT(std::string{result.status().message()}, StartsWith("mesh"));
}

void ExpectRefused(absl::string_view bytes, absl::string_view message,
                   absl::StatusCode code = absl::StatusCode::kInvalidArgument, const Limits& limits = {}) {
  const auto result = Decode(bytes, limits);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.status().code(), code) << result.status();
  EXPECT_THAT(std::string{result.status().message()}, HasSubstr(std::string{message}));
}

TEST(DracoDecoder, GivesDracosOwnFloatsAndReportsQuantization) {
  const TriangleMesh mesh = Sphere(9);
  for (const DracoMethod method : kMethods) {
    for (const int bits : {0, 1, 8, 11, 14, 21}) {
      for (const int speed : {0, 5, 10}) {
        const std::string bytes = EncodeDraco(mesh, {.method = method, .quantization_bits = bits, .speed = speed});
        ASSERT_FALSE(bytes.empty());
        const auto decoded = Decode(bytes);
        ASSERT_TRUE(decoded.ok()) << decoded.status();
        EXPECT_EQ(decoded->quantization_bits, bits);
        EXPECT_EQ(decoded->mesh.vertices, PositionsByDraco(bytes));
        EXPECT_LE(decoded->mesh.triangles.size(), mesh.triangles.size());
      }
    }
  }
}

TEST(DracoDecoder, LosslessEncodingsKeepEveryTriangleExactly) {
  TriangleMesh mesh = Sphere(12);
  // Draco drops triangles that use a point twice or lie on two points; a sphere's poles make none of these.
  for (size_t v = 0; v < mesh.vertices.size(); ++v) mesh.vertices[v][2] += 1e-6f * static_cast<float>(v);
  for (const DracoMethod method : kMethods) {
    const auto decoded = Decode(EncodeDraco(mesh, {.method = method, .quantization_bits = 0}));
    ASSERT_TRUE(decoded.ok()) << decoded.status();
    EXPECT_EQ(TriangleSoup(decoded->mesh), TriangleSoup(mesh));
  }
}

TEST(DracoDecoder, FindsCountsBehindMetadata) {
  for (const DracoMethod method : kMethods) {
    const std::string bytes = EncodeDraco(Sphere(5), {.method = method, .metadata = true});
    EXPECT_TRUE(Decode(bytes).ok()) << Decode(bytes).status();
    ExpectRefused(bytes, "mesh.triangles", absl::StatusCode::kResourceExhausted, {.max_triangles = 7});
  }
}

TEST(DracoDecoder, AcceptsTheDensestMeshes) {
  const std::string bytes = EncodeDraco(FlatGrid(512), {.quantization_bits = 10, .speed = 0});
  const auto decoded = Decode(bytes);
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_GT(decoded->mesh.triangles.size(), 100 * bytes.size());
}

TEST(DracoDecoder, RefusesEveryTruncation) {
  for (const DracoMethod method : kMethods) {
    for (const int bits : {0, 11}) {
      const std::string bytes = EncodeDraco(Sphere(4), {.method = method, .quantization_bits = bits});
      ASSERT_TRUE(Decode(bytes).ok());
      for (size_t length = 0; length < bytes.size(); ++length) {
        const auto result = Decode(bytes.substr(0, length));
        EXPECT_EQ(result.status().code(), absl::StatusCode::kInvalidArgument) << length << " of " << bytes.size();
      }
    }
  }
}

TEST(DracoDecoder, SurvivesEveryValueOfEveryHeaderByte) {
  for (const DracoMethod method : kMethods) {
    const std::string good = EncodeDraco(Sphere(4), {.method = method});
    for (size_t at = 0; at < kHeaderBytes + 8; ++at) {
      for (int value = 0; value < 256; ++value) {
        std::string bytes = good;
        bytes[at] = static_cast<char>(value);
        ExpectClean(Decode(bytes));
      }
    }
  }
}

TEST(DracoDecoder, SurvivesRandomMutations) {
  constexpr unsigned kSeed = 20240607;
  constexpr int kMutations = 10000;
  RecordProperty("seed", kSeed);
  std::mt19937 random(kSeed);
  std::vector<std::string> corpus;
  for (const DracoMethod method : kMethods) {
    for (const int bits : {0, 11})
      corpus.push_back(EncodeDraco(Sphere(5), {.method = method, .quantization_bits = bits}));
  }
  for (int n = 0; n < kMutations; ++n) {
    std::string bytes = corpus[random() % corpus.size()];
    const unsigned changes = 1 + random() % 4;
    for (unsigned change = 0; change < changes; ++change) {
      bytes[kHeaderBytes + random() % (bytes.size() - kHeaderBytes)] = static_cast<char>(random());
    }
    ExpectClean(Decode(bytes));
  }
}

TEST(DracoDecoder, NamesWhatIsNoDracoFile) {
  ExpectRefused("", "mesh: not a Draco file (0 bytes");
  ExpectRefused("solid cube\n facet", "mesh: not a Draco file (17 bytes, beginning with \"solid\")");
  ExpectRefused("DRACO", "truncated or corrupt Draco data");
  ExpectRefused(EncodeDracoPointCloud(Sphere(4)), "mesh: a Draco point cloud, not a triangle mesh");
}

TEST(DracoDecoder, NamesUnknownVersionTypeAndMethod) {
  const std::string good = EncodeDraco(Sphere(4), {});
  const auto with = [&](size_t at, char value) {
    std::string bytes = good;
    bytes[at] = value;
    return bytes;
  };
  ExpectRefused(with(5, 3), "version 3.2");
  ExpectRefused(with(5, 0), "version 0.2");
  ExpectRefused(with(6, 3), "version 2.3");
  ExpectRefused(with(7, 2), "type 2");
  ExpectRefused(with(8, 2), "method 2");
}

TEST(DracoDecoder, RefusesIndicesOutOfRange) {
  // Sequential with raw indices: counts and method are a byte each, as is every index of a mesh this small.
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}};
  std::string bytes = EncodeDraco(mesh, {.method = DracoMethod::kSequential, .quantization_bits = 0});
  ASSERT_TRUE(Decode(bytes).ok());
  ASSERT_EQ(bytes.substr(kHeaderBytes, 3), std::string("\2\4\1", 3));
  bytes[kHeaderBytes + 3 + 4] = 9;
  const auto result = Decode(bytes);
  EXPECT_EQ(result.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(result.status().message(), "mesh: triangle 1 refers to vertex 9 of 4");
}

TEST(DracoDecoder, RefusesPositionsThatAreNotFinite) {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    TriangleMesh mesh = Sphere(4);
    mesh.vertices[17][1] = bad;
    ExpectRefused(EncodeDraco(mesh, {.method = DracoMethod::kSequential, .quantization_bits = 0}),
                  "mesh: vertex 17 is not finite");
  }
}

TEST(DracoDecoder, RefusesMeshesWithoutThreeDimensionalPositions) {
  constexpr DracoMethod kSequential = DracoMethod::kSequential;
  ExpectRefused(EncodeDraco(Sphere(4), {.method = kSequential, .quantization_bits = 0, .as_position = false}),
                "mesh: no POSITION attribute");
  ExpectRefused(EncodeDraco(Sphere(4), {.method = kSequential, .quantization_bits = 0, .position_components = 2}),
                "mesh: POSITION has 2 components, not 3");
}

// A file that ends after the counts it declares, padded to `size` bytes.
std::string Declaring(DracoMethod method, std::vector<uint32_t> counts, uint8_t attributes, size_t size) {
  std::string bytes("DRACO\2\2\1", 8);
  bytes += static_cast<char>(method);
  bytes += std::string(2, '\0');
  draco::EncoderBuffer buffer;
  if (method == DracoMethod::kEdgebreaker) buffer.Encode(uint8_t{0});  // traversal
  for (size_t n = 0; n < counts.size(); ++n) {
    draco::EncodeVarint(counts[n], &buffer);
    if (n == 1 && method == DracoMethod::kEdgebreaker) buffer.Encode(attributes);
  }
  bytes.append(buffer.data(), buffer.size());
  bytes.resize(size, '\0');
  return bytes;
}

TEST(DracoHeader, RefusesCountsOutOfProportionToTheFile) {
  constexpr uint32_t kMany = 50'000'000;
  const auto sequential = [](uint32_t faces, uint32_t points) {
    return Declaring(DracoMethod::kSequential, {faces, points}, 0, 61);
  };
  const auto edgebreaker = [](std::vector<uint32_t> counts, uint8_t attributes = 0) {
    return Declaring(DracoMethod::kEdgebreaker, std::move(counts), attributes, 61);
  };
  ExpectRefused(sequential(kMany, 100), "50000000 triangles declared");
  ExpectRefused(sequential(10, kMany), "50000000 points declared");
  ExpectRefused(edgebreaker({100, kMany, kMany, 0}), "50000000 triangles and points declared");
  ExpectRefused(edgebreaker({kMany, 100, 100, 0}), "50000000 triangles and points declared");
  ExpectRefused(edgebreaker({100, 200, kMany, 0}), "50000000 symbols declared, room for 200");
  ExpectRefused(edgebreaker({100, 200, 200, kMany}), "50000000 split symbols declared, room for 200");
  ExpectRefused(edgebreaker({100, 200, 200, 0}, 255), "255 attributes declared, room for 16");
  ExpectRefused(edgebreaker({100, 0, 0, 0}), "mesh: no triangles");
}

TEST(DracoHeader, HoldsDeclaredCountsAgainstLimits) {
  for (const DracoMethod method : kMethods) {
    const std::string bytes = EncodeDraco(Sphere(8), {.method = method});
    ExpectRefused(bytes, " exceeds 100", absl::StatusCode::kResourceExhausted, {.max_triangles = 100});
    ExpectRefused(bytes, " exceeds 50", absl::StatusCode::kResourceExhausted, {.max_vertices = 50});
  }
}

TEST(DracoHeader, TellsTrianglesByTheFirstBytesWhereTheseDo) {
  const TriangleMesh mesh = Sphere(40);
  for (const DracoMethod method : kMethods) {
    const auto declared = [&](const DracoEncoding& encoding) {
      return DeclaredTriangles(absl::string_view(EncodeDraco(mesh, encoding)).substr(0, kDracoHeadBytes));
    };
    EXPECT_EQ(declared({.method = method}), mesh.triangles.size());
    EXPECT_EQ(declared({.method = method, .metadata = true}), std::nullopt);
  }
  EXPECT_EQ(DeclaredTriangles(absl::string_view("DRACO\2\2\1\1\0\0\0\xFF\xFF", 14)), std::nullopt);
  EXPECT_EQ(DeclaredTriangles(""), std::nullopt);
}

TEST(DracoHeader, ReadsCountsOfOldBitstreams) {
  // Before 2.2, edgebreaker declares new points first; before 2.0, counts are 32-bit words.
  std::string bytes("DRACO\1\1\1\1\0\0\0", 12);
  const auto append = [&](uint32_t count) { bytes.append(reinterpret_cast<const char*>(&count), sizeof(count)); };
  append(7);
  append(100);
  append(4'000'000'000);
  bytes += '\0';
  append(0);
  append(0);
  ExpectRefused(bytes, "mesh.triangles 4000000000 exceeds 67108864", absl::StatusCode::kResourceExhausted);
}

}  // namespace
}  // namespace latvox
