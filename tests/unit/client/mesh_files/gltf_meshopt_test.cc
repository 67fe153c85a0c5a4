// glTF whose buffer views are compressed by EXT_meshopt_compression or KHR_meshopt_compression.
#include "client/mesh_files/gltf_meshopt.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "client/mesh_files/gltf_buffers.h"
#include "tests/unit/client/mesh_files/gltf_document.h"

namespace latvox::client {
namespace {

using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr char kExt[] = "EXT_meshopt_compression";
constexpr char kKhr[] = "KHR_meshopt_compression";
constexpr char kView0[] = "/bufferViews/0/extensions/EXT_meshopt_compression";
constexpr char kView1[] = "/bufferViews/1/extensions/EXT_meshopt_compression";

std::string Attributes(const std::string& bytes, size_t stride) {
  const size_t count = bytes.size() / stride;
  std::string stream(meshopt_encodeVertexBufferBound(count, stride), '\0');
  stream.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(stream.data()), stream.size(), bytes.data(),
                                           count, stride));
  return stream;
}

std::string Indices(const std::vector<uint32_t>& corners, bool triangles) {
  meshopt_encodeIndexVersion(1);
  const size_t count = corners.size();
  std::string stream(
      triangles ? meshopt_encodeIndexBufferBound(count, 1000) : meshopt_encodeIndexSequenceBound(count, 1000), '\0');
  auto* const bytes = reinterpret_cast<unsigned char*>(stream.data());
  stream.resize(triangles ? meshopt_encodeIndexBuffer(bytes, stream.size(), corners.data(), count)
                          : meshopt_encodeIndexSequence(bytes, stream.size(), corners.data(), count));
  return stream;
}

// Puts a stream into a buffer of its own, from which the view takes its bytes. The view's own buffer has none.
void Compress(SortedJson& document, size_t view, const std::string& stream, SortedJson extension,
              const char* name = kExt) {
  SortedJson& described = document["bufferViews"][view];
  extension["buffer"] = document["buffers"].size();
  extension["byteLength"] = stream.size();
  document["buffers"].push_back({{"byteLength", stream.size()}, {"uri", Uri(stream)}});
  const size_t size = extension["count"].get<size_t>() * extension["byteStride"].get<size_t>();
  described = {{"buffer", 0}, {"byteLength", size}, {"extensions", {{name, extension}}}};
  document["buffers"][0] = {{"byteLength", 1000}, {"extensions", {{name, {{"fallback", true}}}}}};
  document["extensionsRequired"] = {name};
}

const std::string kPositions = BytesOf<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
const std::vector<uint32_t> kCorners = {0, 1, 2, 2, 1, 3};

// The square of Document(), compressed.
SortedJson Compressed(const char* name = kExt) {
  SortedJson document = Document();
  Compress(document, 0, Attributes(kPositions, 12), {{"mode", "ATTRIBUTES"}, {"count", 4}, {"byteStride", 12}}, name);
  Compress(document, 1, Indices(kCorners, true), {{"mode", "TRIANGLES"}, {"count", 6}, {"byteStride", 2}}, name);
  return document;
}

// Returns the document with `change` made to the bytes of a stream. No template: in one, Clang 14 does not destroy the
// replaced value, which counts as a leak.
SortedJson Damaged(SortedJson document, size_t buffer, const std::function<void(std::string&)>& change) {
  const auto uri = document["buffers"][buffer]["uri"].get<std::string>();
  std::string bytes;
  EXPECT_TRUE(absl::Base64Unescape(absl::string_view(uri).substr(uri.find(',') + 1), &bytes));
  change(bytes);
  document["buffers"][buffer] = {{"byteLength", bytes.size()}, {"uri", Uri(bytes)}};
  document["bufferViews"][buffer - 1]["extensions"][kExt]["byteLength"] = bytes.size();
  return document;
}

void ExpectSquare(const SortedJson& document) {
  const auto mesh = Parse(document);
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  const Mesh wanted = Parse(Document()).value();
  EXPECT_EQ(mesh->positions, wanted.positions);
  EXPECT_EQ(mesh->triangles, wanted.triangles);
  EXPECT_THAT(mesh->warnings, IsEmpty());
}

TEST(GltfMeshopt, ViewsAreDecodedFromTheBufferOfTheExtension) {
  ExpectSquare(Compressed(kExt));
  ExpectSquare(Compressed(kKhr));
  SortedJson used = Compressed();
  used["extensionsUsed"] = used["extensionsRequired"];
  used.erase("extensionsRequired");
  ExpectSquare(used);
}

TEST(GltfMeshopt, IndicesMayBeASequenceAndHaveTwoOrFourBytes) {
  for (const int bytes : {2, 4}) {
    for (const bool triangles : {false, true}) {
      SortedJson document = Compressed();
      Compress(document, 1, Indices(kCorners, triangles),
               {{"mode", triangles ? "TRIANGLES" : "INDICES"}, {"count", 6}, {"byteStride", bytes}});
      document["accessors"][1]["componentType"] = bytes == 2 ? 5123 : 5125;
      ExpectSquare(document);
    }
  }
}

TEST(GltfMeshopt, QuantizedPositionsAreDecodedFirst) {
  SortedJson document = Compressed();
  const std::string bytes = BytesOf<int16_t>({0, 0, 0, 0, 32767, 0, 0, 0, 0, 32767, 0, 0, 32767, 32767, 0, 0});
  Compress(document, 0, Attributes(bytes, 8), {{"mode", "ATTRIBUTES"}, {"count", 4}, {"byteStride", 8}});
  document["bufferViews"][0]["byteStride"] = 8;
  document["accessors"][0].update({{"componentType", 5122}, {"normalized", true}});
  ExpectSquare(document);
}

TEST(GltfMeshopt, ExponentialFloatsAreFiltered) {
  std::vector<uint32_t> exponential(12);
  const auto* const floats = reinterpret_cast<const float*>(kPositions.data());
#if MESHOPTIMIZER_VERSION < 200  // it has this mode alone
  meshopt_encodeFilterExp(exponential.data(), 4, 12, 15, floats);
#else
  meshopt_encodeFilterExp(exponential.data(), 4, 12, 15, floats, meshopt_EncodeExpSharedVector);
#endif
  SortedJson document = Compressed();
  Compress(document, 0, Attributes(BytesOf(exponential), 12),
           {{"mode", "ATTRIBUTES"}, {"filter", "EXPONENTIAL"}, {"count", 4}, {"byteStride", 12}});
  ExpectSquare(document);
}

// An instance turned by a quarter about z.
TEST(GltfMeshopt, QuaternionsOfInstancesAreFiltered) {
  const std::vector<float> turn = {0, 0, 0.70710678F, 0.70710678F};
  std::vector<uint16_t> packed(4);
  meshopt_encodeFilterQuat(packed.data(), 1, 8, 16, turn.data());
  SortedJson document = Compressed();
  Compress(document, 2, Attributes(BytesOf(packed), 8),
           {{"mode", "ATTRIBUTES"}, {"filter", "QUATERNION"}, {"count", 1}, {"byteStride", 8}});
  document["accessors"].push_back(
      {{"bufferView", 2}, {"componentType", 5122}, {"normalized", true}, {"count", 1}, {"type", "VEC4"}});
  document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = {{"attributes", {{"ROTATION", 2}}}};
  const auto mesh = Parse(document);
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_THAT(mesh->positions[1], ElementsAre(DoubleNear(0, 1e-4), DoubleNear(1, 1e-4), 0));
}

TEST(GltfMeshopt, OctahedralNormalsAreFiltered) {
  const std::vector<float> normal = {0, 0.6F, -0.8F, 0};
  std::vector<int16_t> packed(4);
  meshopt_encodeFilterOct(packed.data(), 1, 8, 16, normal.data());
  const std::string stream = Attributes(BytesOf(packed), 8);
  const auto bytes =
      DecodeGltfMeshopt({{"mode", "ATTRIBUTES"}, {"filter", "OCTAHEDRAL"}, {"count", 1}, {"byteStride", 8}},
                        {{"byteLength", 8}}, stream, 8);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  std::array<int16_t, 4> decoded;
  ASSERT_THAT(*bytes, SizeIs(sizeof(decoded)));
  bytes->copy(reinterpret_cast<char*>(decoded.data()), sizeof(decoded));
  EXPECT_NEAR(decoded[1], 0.6 * 32767, 4);
  EXPECT_NEAR(decoded[2], -0.8 * 32767, 4);
}

TEST(GltfMeshopt, ErrorsNameViewFieldAndLimit) {
  const auto says = [](const std::string& place, const SortedJson& value, const char* text) {
    const std::string refusal = Refusal(With(Compressed(), place.c_str(), value));
    EXPECT_THAT(refusal, HasSubstr(text)) << place;
  };
  const std::string view0 = kView0, view1 = kView1;
  says(view0 + "/mode", "MESHLETS",
       "bufferViews[0].EXT_meshopt_compression: mode \"MESHLETS\" is not one of ATTRIBUTES, TRIANGLES, INDICES");
  says(view0 + "/filter", "COLOR", "filter \"COLOR\" is not one of NONE, OCTAHEDRAL, QUATERNION, EXPONENTIAL");
  says(view0 + "/byteStride", 10, "byteStride 10 is not a multiple of 4 from 4 to 256");
  says(view0 + "/byteStride", 260, "byteStride 260 is not a multiple of 4 from 4 to 256");
  says(view0 + "/byteStride", 0, "byteStride 0 is not a multiple of 4");
  says(view0 + "/filter", "OCTAHEDRAL", "byteStride 12 is not 4 or 8, as the filter OCTAHEDRAL needs");
  says(view0 + "/filter", "QUATERNION", "byteStride 12 is not 8, as the filter QUATERNION needs");
  says(view1 + "/byteStride", 8,
       "bufferViews[1].EXT_meshopt_compression: byteStride 8 is not 2 or 4, as the mode TRIANGLES needs");
  says(view1 + "/filter", "EXPONENTIAL", "filter \"EXPONENTIAL\" is not NONE, as the mode TRIANGLES needs");
  says(view1 + "/count", 7, "count 7 is not a multiple of 3, as the mode TRIANGLES needs");
  says(view0 + "/count", 0, "count 0 is not 1 or more");
  says(view0 + "/count", 5, "count 5 of byteStride 12 is 60 bytes, not 48, the byteLength of the buffer view");
  says(view0 + "/count", -1, "count: -1 is not a whole number");
  says(view0 + "/buffer", 9, "bufferViews[0].EXT_meshopt_compression: buffer 9 is not among the 3 buffers");
  says(view0 + "/byteOffset", 1, "bufferViews[0].EXT_meshopt_compression ends at byte ");
  says(view0 + "/buffer", 0, "buffers[0] is a fallback without bytes, for buffer views with EXT_meshopt_compression");
  says("/bufferViews/0/byteStride", 16, "byteStride 12 is not 16, that of the buffer view");
  SortedJson document = Compressed();
  document["bufferViews"][0]["extensions"][kExt].erase("byteStride");
  EXPECT_THAT(Refusal(document), HasSubstr("bufferViews[0].EXT_meshopt_compression: byteStride is missing"));
  document = Compressed();
  document["bufferViews"][0].erase("extensions");
  EXPECT_THAT(Refusal(document), HasSubstr("buffers[0] is a fallback without bytes"));
}

// A stream of 64 bytes cannot hold the elements that the fields tell, so no memory is taken for them.
TEST(GltfMeshopt, MemoryIsBoundedByTheStreamAndALimit) {
  const SortedJson extension = {{"mode", "ATTRIBUTES"}, {"count", 1 << 20}, {"byteStride", 256}};
  const std::string stream(64, '\xA0');
  const auto decode = [&](uint64_t most) {
    return DecodeGltfMeshopt(extension, {{"byteLength", 1 << 28}}, stream, most).status();
  };
  EXPECT_EQ(decode((1 << 28) - 1).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(decode((1 << 28) - 1).message()),
              HasSubstr("count 1048576 of byteStride 256 exceeds 268435455"));
  EXPECT_THAT(std::string(decode(1 << 28).message()), HasSubstr("byteLength 64 is too short for 268435456 bytes"));
}

TEST(GltfMeshopt, TheLimitHoldsForAllViewsTogether) {
  const std::string text = Compressed().dump();
  const auto document = ParseGltfDocument(text);
  ASSERT_TRUE(document.ok()) << document.status();
  const auto reads = [&](uint64_t most) {
    GltfBuffers buffers(*document, "", most);
    EXPECT_TRUE(buffers.View({{"bufferView", 0}}).ok());
    EXPECT_TRUE(buffers.View({{"bufferView", 0}}).ok());  // decoded once
    return buffers.View({{"bufferView", 1}}).status();
  };
  EXPECT_TRUE(reads(48 + 12).ok());
  EXPECT_EQ(reads(48 + 11).code(), absl::StatusCode::kResourceExhausted);
}

TEST(GltfMeshopt, NewerStreamsAreRefusedUnlessTheBufferOfTheViewHasTheBytes) {
  SortedJson document = Damaged(Compressed(), 1, [](std::string& bytes) { bytes[0] = '\xA1'; });
  EXPECT_THAT(Refusal(document), HasSubstr("bufferViews[0].EXT_meshopt_compression: the stream of mode ATTRIBUTES has "
                                           "version 1; latvox reads version 0"));
  document["buffers"][0] = {{"byteLength", kPositions.size()}, {"uri", Uri(kPositions)}};
  EXPECT_FALSE(Parse(document).ok());  // the extension is required
  document.erase("extensionsRequired");
  ExpectSquare(document);
  document["bufferViews"][0]["extensions"][kExt]["filter"] = "COLOR";
  ExpectSquare(document);
}

TEST(GltfMeshopt, EveryTruncationIsAnError) {
  for (const size_t buffer : {size_t{1}, size_t{2}}) {
    size_t size = 1;
    for (size_t cut = 1; cut <= size; ++cut) {
      const SortedJson document = Damaged(Compressed(), buffer, [&](std::string& bytes) {
        size = bytes.size();
        bytes.resize(size - cut);
      });
      EXPECT_FALSE(Parse(document).ok()) << buffer << " " << cut;
    }
    EXPECT_THAT(Refusal(Damaged(Compressed(), buffer, [](std::string& bytes) { bytes += std::string(40, '\1'); })),
                HasSubstr("is damaged: its "));
  }
}

// A damaged stream is an error, or gives other numbers.
TEST(GltfMeshopt, MutationsGiveAnErrorOrAMesh) {
  for (const size_t buffer : {size_t{1}, size_t{2}}) {
    size_t size = 1, errors = 0;
    for (size_t at = 0; at < size; ++at) {
      for (const int flip : {1, 16, 255}) {
        const auto mesh = Parse(Damaged(Compressed(), buffer, [&](std::string& bytes) {
          size = bytes.size();
          bytes[at] = static_cast<char>(bytes[at] ^ flip);
        }));
        errors += !mesh.ok();
        if (!mesh.ok()) continue;
        EXPECT_THAT(mesh->triangles, Each(Each(testing::Lt(mesh->positions.size()))));
      }
    }
    EXPECT_GT(errors, 0u);
  }
}

}  // namespace
}  // namespace latvox::client
