// The steps of a call's computation, without a channel.
#include "server/work/computation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "server/base/errors.h"
#include "server/wire/convert.h"
#include "server/work/mesh_upload.h"
#include "tests/unit/server/environment.h"
#include "tests/unit/server/meshes.h"
#include "tests/unit/server/thread_decoder.h"

namespace latvox {
namespace {

v1::VoxelizeSpec GoodSpec() {
  v1::VoxelizeSpec spec;
  spec.mutable_lattice()->set_named(v1::NAMED_LATTICE_BCC);
  spec.set_resolution(64);
  return spec;
}

const auto kNever = [] { return false; };

// Sends `bytes` through the computation's first step, and waits for its end.
absl::Status Decode(Computation& computation, std::string bytes) {
  MeshUpload upload(0, 1 << 30);
  EXPECT_TRUE(upload.Append(std::move(bytes)).ok());
  if (absl::Status status = computation.ReceiveMesh(std::move(upload)); !status.ok()) return status;
  if (const auto at_once = computation.DecodeAtOnce()) return *at_once;
  std::promise<absl::Status> decoded;
  computation.Decode([&](const absl::Status& status) { decoded.set_value(status); });
  return decoded.get_future().get();
}

absl::Status Begin(Computation& computation, const Computation::Deliver& deliver) {
  const absl::Status status = computation.Measure();
  return status.ok() ? computation.Start(deliver) : status;
}

// The bricks of every message, and the summary, of a computation that is paused after every `stride` messages.
std::vector<v1::VoxelizeResponse> Compute(const JobSpec& spec, int stride) {
  ThreadDecoder decoder;
  TestEnvironment environment(decoder);
  Computation computation(spec, "id", environment.shared());
  EXPECT_TRUE(Decode(computation, EncodeDraco(Sphere(20), {})).ok());
  std::vector<v1::VoxelizeResponse> messages;
  const auto deliver = [&](v1::VoxelizeResponse&& message) {
    messages.push_back(std::move(message));
    return static_cast<int>(messages.size()) % stride != 0;
  };
  EXPECT_TRUE(Begin(computation, deliver).ok());
  for (;;) {
    const absl::StatusOr<bool> done = computation.Advance(deliver, kNever);
    EXPECT_TRUE(done.ok()) << done.status();
    if (!done.ok() || *done) return messages;
  }
}

TEST(Computation, GivesTheSameBricksHoweverOftenItIsPaused) {
  const JobSpec spec = *JobSpecFromProto(GoodSpec(), {});
  std::vector<std::string> digests;
  for (const int stride : {1, 2, 1000}) {
    const auto messages = Compute(spec, stride);
    ASSERT_TRUE(messages.front().has_accepted() && messages.back().has_summary());
    digests.push_back(messages.back().summary().certificate().digest());
    uint64_t bricks = 0;
    for (const auto& message : messages) bricks += message.bricks().masks().size() / 64;
    EXPECT_EQ(messages.back().summary().bricks(), bricks);
  }
  EXPECT_THAT(digests, ::testing::Each(digests.front()));
}

// Else, it could be refused when it has been accepted.
TEST(Computation, ReservesBeforehandWhatVerificationKeeps) {
  const auto ignore = [](v1::VoxelizeResponse&&) { return true; };
  ThreadDecoder decoder;
  for (const auto named : {v1::NAMED_LATTICE_CARTESIAN, v1::NAMED_LATTICE_BCC, v1::NAMED_LATTICE_FCC}) {
    uint64_t without = 0;
    for (const bool verify : {false, true}) {
      TestEnvironment environment(decoder);
      v1::VoxelizeSpec spec = GoodSpec();
      spec.mutable_lattice()->set_named(named);
      spec.set_verify(verify);
      Computation computation(*JobSpecFromProto(spec, {}), "id", environment.shared());
      ASSERT_TRUE(Decode(computation, EncodeDraco(Sphere(20), {})).ok());
      ASSERT_TRUE(Begin(computation, ignore).ok());
      const uint64_t reserved = environment.memory.reserved();
      for (bool done = false; !done;) {
        const absl::StatusOr<bool> advanced = computation.Advance([](v1::VoxelizeResponse&&) { return false; }, kNever);
        ASSERT_TRUE(advanced.ok()) << advanced.status();
        EXPECT_EQ(environment.memory.reserved(), reserved);
        done = *advanced;
      }
      if (verify) {
        EXPECT_GT(reserved, without);
      }
      without = reserved;
    }
  }
}

TEST(Computation, ReservesWhatThinningTakesWhereTrianglesFillAVolume) {
  ThreadDecoder decoder;
  const auto reserved = [&](int copies, bool minimal) {
    TestEnvironment environment(decoder);
    v1::VoxelizeSpec spec = GoodSpec();
    spec.set_minimal(minimal);
    TriangleMesh mesh = Sphere(20);
    const auto once = mesh.triangles;
    for (int n = 1; n < copies; ++n) mesh.triangles.insert(mesh.triangles.end(), once.begin(), once.end());
    Computation computation(*JobSpecFromProto(spec, {}), "id", environment.shared());
    EXPECT_TRUE(Decode(computation, EncodeDraco(mesh, {.method = DracoMethod::kSequential})).ok());
    EXPECT_TRUE(Begin(computation, [](v1::VoxelizeResponse&&) { return true; }).ok());
    return environment.memory.reserved();
  };
  constexpr uint64_t kMebibyte = 1 << 20;
  EXPECT_LT(reserved(1, true), reserved(1, false) + 10 * kMebibyte);
  EXPECT_GT(reserved(40, true), reserved(40, false) + 40 * kMebibyte);
}

class CountingDecoder final : public MeshDecoder {
 public:
  std::shared_ptr<Decoding> Start(EncodedMesh mesh, const Limits& limits, Reserve reserve, Done done) override {
    ++decodes;
    return decoder_.Start(std::move(mesh), limits, std::move(reserve), std::move(done));
  }
  int decodes = 0;

 private:
  ThreadDecoder decoder_;
};

TEST(Computation, DecodesAMeshTwiceAtMost) {
  const std::string bytes = EncodeDraco(Sphere(20), {});
  v1::VoxelizeSpec spec = GoodSpec();
  const MeshDigest digest = DigestOf(absl::Cord(bytes));
  spec.set_mesh_sha256(std::string(digest.begin(), digest.end()));
  const auto ignore = [](v1::VoxelizeResponse&&) { return true; };
  CountingDecoder decoder;
  TestEnvironment environment(decoder);
  std::vector<std::string> digests;
  for (const int decodes : {1, 2, 2, 2}) {  // the second time, it is worth keeping
    Computation computation(*JobSpecFromProto(spec, {}), "id", environment.shared());
    ASSERT_TRUE(Decode(computation, bytes).ok());
    EXPECT_EQ(decoder.decodes, decodes);
    ASSERT_TRUE(Begin(computation, ignore).ok());
    ASSERT_TRUE(computation
                    .Advance(
                        [&](v1::VoxelizeResponse&& message) {
                          if (message.has_summary()) digests.push_back(message.summary().certificate().digest());
                          return true;
                        },
                        kNever)
                    .ok());
    computation.Free();
    EXPECT_EQ(environment.memory.reserved(), 0);
  }
  EXPECT_EQ(digests.size(), 4);
  EXPECT_THAT(digests, ::testing::Each(digests.front()));
}

TEST(Computation, ReadsPlainArraysTwiceAtMost) {
  const TriangleMesh sphere = Sphere(20);
  v1::VoxelizeSpec spec = GoodSpec();
  v1::RawMesh& raw = *spec.mutable_raw_mesh();
  raw.set_vertices(sphere.vertices.size());
  raw.set_triangles(sphere.triangles.size());
  raw.set_positions(v1::POSITION_TYPE_FLOAT32);
  std::string bytes(reinterpret_cast<const char*>(sphere.vertices.data()), sphere.vertices.size() * sizeof(Vec3f));
  bytes.append(reinterpret_cast<const char*>(sphere.triangles.data()),
               sphere.triangles.size() * sizeof(sphere.triangles[0]));
  const MeshDigest digest = DigestOf(absl::Cord(bytes));
  spec.set_mesh_sha256(std::string(digest.begin(), digest.end()));
  CountingDecoder decoder;
  TestEnvironment environment(decoder);
  std::vector<std::string> digests;
  for (const bool reads : {true, true, false, false}) {  // the second time, it is worth keeping
    Computation computation(*JobSpecFromProto(spec, {}), "id", environment.shared());
    const auto deliver = [&](v1::VoxelizeResponse&& message) {
      if (message.has_summary()) digests.push_back(message.summary().certificate().digest());
      return true;
    };
    ASSERT_TRUE(Decode(computation, bytes).ok());
    EXPECT_EQ(computation.facts().decode_ms > 0, reads);
    ASSERT_TRUE(Begin(computation, deliver).ok());
    ASSERT_TRUE(computation.Advance(deliver, kNever).ok());
  }
  EXPECT_EQ(decoder.decodes, 0);
  EXPECT_EQ(digests.size(), 4);
  EXPECT_THAT(digests, ::testing::Each(digests.front()));
}

TEST(Computation, LeavesAKeptMeshOverTheCallersLimitsToTheDecoder) {
  const std::string bytes = EncodeDraco(Sphere(20), {});
  v1::VoxelizeSpec spec = GoodSpec();
  const MeshDigest digest = DigestOf(absl::Cord(bytes));
  spec.set_mesh_sha256(std::string(digest.begin(), digest.end()));
  ThreadDecoder decoder;
  TestEnvironment environment(decoder);
  environment.meshes.Put(digest, absl::Cord(bytes));
  environment.meshes.KeepDecoded(digest, {}, DecodedMesh{Sphere(20), 0, ExtentOf(Sphere(20))});
  CallEnvironment narrow = environment.shared();
  narrow.limits.max_triangles = 10;
  Computation computation(*JobSpecFromProto(spec, {}), "id", narrow);
  EXPECT_THAT(std::string(Decode(computation, bytes).message()), ::testing::HasSubstr("mesh.triangles"));
}

// Triangles that all cover the same few voxels of the region. The estimate spreads them over the mesh's box.
JobSpec MisjudgedSpec() {
  v1::VoxelizeSpec spec = GoodSpec();
  spec.mutable_lattice()->set_named(v1::NAMED_LATTICE_CARTESIAN);
  spec.set_voxel_size(1);
  v1::Ijk &low = *spec.mutable_region()->mutable_min(), &high = *spec.mutable_region()->mutable_max();
  low.set_i(20);
  low.set_j(20);
  low.set_k(-4);
  high.set_i(28);
  high.set_j(28);
  high.set_k(4);
  return *JobSpecFromProto(spec, {});
}

TriangleMesh MisjudgedMesh() {
  TriangleMesh mesh{{{0, 0, 0.3F}, {90, 0, 0.3F}, {0, 90, 0.7F}, {90, 90, 90}, {90, 89, 90}, {89, 90, 90}},
                    {{3, 4, 5}}};
  mesh.triangles.insert(mesh.triangles.end(), 30000, {0, 1, 2});
  return mesh;
}

TEST(Computation, IsInterruptedInTheMiddleOfATileOnceASmallJobHasTakenLong) {
  ThreadDecoder decoder;
  TestEnvironment environment(decoder);
  const std::string bytes = EncodeDraco(MisjudgedMesh(), {.method = DracoMethod::kSequential});
  std::vector<std::string> digests;
  for (const bool overseen : {false, true}) {
    Computation computation(MisjudgedSpec(), "id", environment.shared());
    ASSERT_TRUE(Decode(computation, bytes).ok());
    const auto deliver = [&](v1::VoxelizeResponse&& message) {
      if (message.has_summary()) digests.push_back(message.summary().certificate().digest());
      return true;
    };
    ASSERT_TRUE(Begin(computation, deliver).ok());
    ASSERT_FALSE(computation.IsLarge());
    std::jthread overseer([&](const std::stop_token& over) {
      while (overseen && !over.stop_requested()) EXPECT_TRUE(computation.Oversee().ok());
    });
    int pauses = 0;
    for (absl::StatusOr<bool> done = false; !*done; pauses += *done ? 0 : 1) {
      done = computation.Advance(deliver, kNever);
      ASSERT_TRUE(done.ok()) << done.status();
    }
    // An overseer that hesitates before its Interrupt may end the next turn too.
    EXPECT_THAT(pauses, ::testing::AllOf(::testing::Ge(overseen ? 1 : 0), ::testing::Le(overseen ? 2 : 0)));
    EXPECT_TRUE(computation.IsLarge());
  }
  EXPECT_EQ(digests.size(), 2);
  EXPECT_EQ(digests.front(), digests.back());
}

TEST(Computation, IsCancelledBeforeEachOfItsSteps) {
  ThreadDecoder decoder;
  TestEnvironment environment(decoder);
  const auto ignore = [](v1::VoxelizeResponse&&) { return true; };
  for (const int steps : {0, 1, 2, 3}) {
    Computation computation(*JobSpecFromProto(GoodSpec(), {}), "id", environment.shared());
    if (steps == 0) computation.Cancel();
    absl::Status status = Decode(computation, EncodeDraco(Sphere(20), {}));
    if (steps > 0) {
      ASSERT_TRUE(status.ok()) << status;
      if (steps == 1) computation.Cancel();
      status = computation.Measure();
    }
    if (steps > 1) {
      ASSERT_TRUE(status.ok()) << status;
      if (steps == 2) computation.Cancel();
      status = computation.Start(ignore);
    }
    if (steps > 2) {
      ASSERT_TRUE(status.ok()) << status;
      computation.Cancel();
      status = computation.Advance(ignore, kNever).status();
    }
    EXPECT_EQ(status.code(), absl::StatusCode::kCancelled) << steps;
  }
}

TEST(Computation, NamesTheFieldOfWhatCoreRefuses) {
  ThreadDecoder decoder;
  TestEnvironment environment(decoder);
  v1::VoxelizeSpec proto = GoodSpec();
  proto.set_voxel_size(1e-6);
  Computation computation(*JobSpecFromProto(proto, {}), "id", environment.shared());
  ASSERT_TRUE(Decode(computation, EncodeDraco(Sphere(20), {})).ok());
  const absl::Status status = Begin(computation, [](v1::VoxelizeResponse&&) { return true; });
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(CauseOf(status)->reason, "LIMIT_EXCEEDED");
  EXPECT_EQ(CauseOf(status)->field, "voxel_size");
  EXPECT_EQ(CauseOf(status)->limit, "131072");
  EXPECT_EQ(CauseOf(status)->limit_name, "max_extent");
}

}  // namespace
}  // namespace latvox
