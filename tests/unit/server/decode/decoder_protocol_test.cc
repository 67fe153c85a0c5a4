// The messages of a decoder process: a mesh, an error, or invalid ones, which are found out.
#include "server/decode/decoder_protocol.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "server/base/errors.h"
#include "tests/unit/dose.h"
#include "tests/unit/server/meshes.h"

namespace latvox {
namespace {

using Progress = MeshReceiver::Progress;
using Triangle = std::array<uint32_t, 3>;

template <class T, class Allocator>
absl::string_view Bytes(const std::vector<T, Allocator>& elements) {
  return {reinterpret_cast<const char*>(elements.data()), elements.size() * sizeof(T)};
}

absl::string_view Bytes(const MeshFrame& head) { return {reinterpret_cast<const char*>(&head), sizeof(head)}; }

const std::vector<Vec3f> kCorners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
const std::vector<Triangle> kTriangle = {{0, 1, 2}};
const MeshFrame kHead{3, 1, 11};

TEST(MeshReceiver, PutsAMeshTogetherFromFramesOfAnySize) {
  const TriangleMesh mesh = Sphere(10);
  for (const size_t step : {size_t{1}, size_t{7}, mesh.vertices.size()}) {
    MeshReceiver receiver({});
    const MeshFrame head{static_cast<uint32_t>(mesh.vertices.size()), static_cast<uint32_t>(mesh.triangles.size()), 14};
    EXPECT_EQ(receiver.Receive(FrameKind::kMesh, Bytes(head)), Progress::kMore);
    for (size_t at = 0; at < mesh.vertices.size(); at += step) {
      const absl::string_view part = Bytes(mesh.vertices).substr(at * sizeof(Vec3f), step * sizeof(Vec3f));
      EXPECT_EQ(receiver.Receive(FrameKind::kVertices, part), Progress::kMore);
    }
    for (size_t at = 0; at < mesh.triangles.size(); at += step) {
      const absl::string_view part = Bytes(mesh.triangles).substr(at * sizeof(Triangle), step * sizeof(Triangle));
      EXPECT_EQ(receiver.Receive(FrameKind::kTriangles, part), Progress::kMore);
    }
    ASSERT_EQ(receiver.Receive(FrameKind::kDone, ""), Progress::kDone);
    const auto result = std::move(receiver).result();
    ASSERT_TRUE(result.ok()) << result.status();
    EXPECT_EQ(result->mesh.vertices, mesh.vertices);
    EXPECT_EQ(result->mesh.triangles, mesh.triangles);
    EXPECT_EQ(result->quantization_bits, 14);
  }
}

struct Frame {
  FrameKind kind;
  std::string bytes;
};

// Takes frames up to the first that does not lead on.
Progress ReceiveAll(const std::vector<Frame>& frames, const Limits& limits = {}) {
  MeshReceiver receiver(limits);
  for (const Frame& frame : frames) {
    const std::vector<uint32_t> words((frame.bytes.size() + 3) / 4);
    if (frame.bytes.size() > 0)
      std::memcpy(const_cast<uint32_t*>(words.data()), frame.bytes.data(), frame.bytes.size());
    const absl::string_view aligned(reinterpret_cast<const char*>(words.data()), frame.bytes.size());
    if (const Progress progress = receiver.Receive(frame.kind, aligned); progress != Progress::kMore) return progress;
  }
  return Progress::kMore;
}

Frame Head(const MeshFrame& head) { return {FrameKind::kMesh, std::string(Bytes(head))}; }
Frame Vertices(const std::vector<Vec3f>& vertices) { return {FrameKind::kVertices, std::string(Bytes(vertices))}; }
Frame Triangles(const std::vector<Triangle>& all) { return {FrameKind::kTriangles, std::string(Bytes(all))}; }
const Frame kEnd{FrameKind::kDone, ""};

TEST(MeshReceiver, FindsEveryKindOfNonsense) {
  ASSERT_EQ(ReceiveAll({Head(kHead), Vertices(kCorners), Triangles(kTriangle), kEnd}), Progress::kDone);
  ASSERT_EQ(ReceiveAll({Head(kHead), Triangles(kTriangle), Vertices(kCorners), kEnd}), Progress::kDone);
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  const std::vector<std::vector<Frame>> nonsense = {
      {kEnd},                                                      // nothing
      {Vertices(kCorners)},                                        // no head
      {Triangles(kTriangle)},                                      // no head
      {Head(kHead), Head(kHead)},                                  // two
      {{FrameKind::kMesh, "short"}},                               //
      {Head({3, 0, 11})},                                          // no triangles
      {Head({3, 1, 32})},                                          // more bits than a number has
      {Head(kHead), Vertices(kCorners), kEnd},                     // triangles missing
      {Head(kHead), Triangles(kTriangle), kEnd},                   // vertices missing
      {Head(kHead), Vertices(kCorners), Vertices({{0, 0, 0}})},    // one too many
      {Head(kHead), Triangles(kTriangle), Triangles(kTriangle)},   //
      {Head(kHead), Triangles({{0, 1, 3}})},                       // index out of range
      {Head(kHead), Triangles({{UINT32_MAX, 1, 2}})},              //
      {Head({0, 1, 0}), Triangles({{0, 0, 0}})},                   //
      {Head(kHead), Vertices({{0, 0, nan}})},                      // not finite
      {Head(kHead), Vertices({{-infinity, 0, 0}})},                //
      {Head(kHead), {FrameKind::kVertices, std::string(13, 0)}},   // not whole
      {Head(kHead), {FrameKind::kTriangles, std::string(16, 0)}},  //
      {Head(kHead), Vertices(kCorners), Triangles(kTriangle), {FrameKind::kDone, "1234"}},
      {{FrameKind::kReady, std::string(8, 0)}},
      {{static_cast<FrameKind>(99), ""}},
  };
  for (size_t n = 0; n < nonsense.size(); ++n) EXPECT_EQ(ReceiveAll(nonsense[n]), Progress::kBroken) << n;
}

TEST(MeshReceiver, HoldsCountsAgainstTheLimitsAgain) {
  EXPECT_EQ(ReceiveAll({Head({100, 50, 0})}, {.max_triangles = 50, .max_vertices = 100}), Progress::kMore);
  EXPECT_EQ(ReceiveAll({Head({101, 50, 0})}, {.max_triangles = 50, .max_vertices = 100}), Progress::kBroken);
  EXPECT_EQ(ReceiveAll({Head({100, 51, 0})}, {.max_triangles = 50, .max_vertices = 100}), Progress::kBroken);
}

TEST(MeshReceiver, GivesOnlyMeshesThatCoreAcceptsWhateverComes) {
  std::mt19937 random(1);
  int done = 0;
  for (int n = 0; n < Dose(20000, 3000); ++n) {
    std::vector<Frame> frames = {Head(kHead), Vertices(kCorners), Triangles(kTriangle), kEnd};
    Frame& victim = frames[random() % 3];
    victim.bytes[random() % victim.bytes.size()] = static_cast<char>(random());
    MeshReceiver receiver({});
    Progress progress = Progress::kMore;
    for (const Frame& frame : frames) {
      std::vector<uint32_t> words(frame.bytes.size() / 4);
      if (frame.bytes.size() > 0) std::memcpy(words.data(), frame.bytes.data(), frame.bytes.size());
      if (progress == Progress::kMore) progress = receiver.Receive(frame.kind, Bytes(words));
    }
    if (progress != Progress::kDone) continue;
    ++done;
    const auto result = std::move(receiver).result();
    ASSERT_TRUE(result.ok());
    EXPECT_TRUE(CheckMesh(result->mesh).ok()) << CheckMesh(result->mesh);
  }
  EXPECT_GT(done, Dose(1000, 150));
}

TEST(DecoderError, ComesBackAsItWasSent) {
  const absl::Status errors[] = {BadMesh("triangle 5 refers to vertex 7 of 6"), LimitExceeded("mesh.triangles", 8, 7),
                                 NoMemoryToDecode()};
  for (const absl::Status& error : errors) {
    const std::string frame = EncodeError(error);
    EXPECT_EQ(frame.size() % 4, 0);
    const absl::Status back = DecodeError(frame);
    EXPECT_EQ(back.code(), error.code());
    EXPECT_EQ(back.message(), error.message());
    EXPECT_TRUE(CauseOf(back) == CauseOf(error));
  }
}

TEST(DecoderError, IsShortPrintableAndAnErrorWhateverComes) {
  std::mt19937 random(1);
  for (const size_t size : {0, 4, 100, 65520}) {
    std::string frame(size, '\0');
    for (char& c : frame) c = static_cast<char>(random());
    const absl::Status status = DecodeError(frame);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_LE(status.message().size(), 1024);
    for (const char c : status.message()) EXPECT_TRUE(c >= ' ' && c <= '~');
  }
  const std::string long_text(5000, 'x');
  EXPECT_LE(EncodeError(BadMesh(long_text)).size(), 1024);
}

}  // namespace
}  // namespace latvox
