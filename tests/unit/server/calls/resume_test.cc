// Streams that go on where they were broken, meshes that are kept, clients that stop taking part: through a real
// channel.
#include <gmock/gmock.h>

#include <set>

#include "absl/strings/str_cat.h"
#include "core/voxelizer/digest.h"
#include "tests/unit/server/calls.h"
#include "tests/unit/server/error_details.h"

namespace latvox {
namespace {

using ::testing::HasSubstr;

v1::VoxelizeSpec SpecOfKept(uint32_t resolution, const std::string& bytes) {
  v1::VoxelizeSpec spec = Spec(resolution);
  spec.set_mesh_sha256(Sha256(bytes));
  return spec;
}

using ResumeTest = ServerTest;

TEST_F(ResumeTest, APutMeshServesManyRequests) {
  Start();
  v1::PutMeshResponse response;
  ASSERT_TRUE(PutMesh(*stub_, WholeMesh(SphereBytes()), response).ok());
  EXPECT_FALSE(response.already_stored());
  EXPECT_FALSE(response.request_id().empty());
  for (const uint32_t resolution : {20u, 50u}) {
    const Answer sent = Voxelize(*stub_, Spec(resolution), SphereBytes());
    const Answer kept = Voxelize(*stub_, SpecOfKept(resolution, SphereBytes()), "");
    ASSERT_TRUE(kept.status.ok()) << kept.status.error_message();
    EXPECT_EQ(kept.summary().certificate().digest(), sent.summary().certificate().digest());
    EXPECT_EQ(kept.summary().mesh_bytes(), SphereBytes().size());
  }
  ASSERT_TRUE(PutMesh(*stub_, WholeMesh(SphereBytes()), response).ok());
  EXPECT_TRUE(response.already_stored());
}

TEST_F(ResumeTest, AMeshThatIsNotKeptIsNotFoundUntilItIsSentWithItsDigest) {
  Start();
  const v1::VoxelizeSpec spec = SpecOfKept(20, SphereBytes());
  const Answer missing = Voxelize(*stub_, spec, "");
  EXPECT_EQ(missing.status.error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_THAT(missing.status.error_message(), HasSubstr("mesh_sha256"));
  EXPECT_TRUE(Voxelize(*stub_, spec, SphereBytes()).status.ok());
  EXPECT_TRUE(Voxelize(*stub_, spec, "").status.ok());
}

TEST_F(ResumeTest, AStoreOfNoBytesKeepsNothingAndTurnsNoJobAway) {
  options_.limits.mesh_store_bytes = 0;
  Start();
  const v1::VoxelizeSpec spec = SpecOfKept(20, SphereBytes());
  for (int n = 0; n < 2; ++n) {
    EXPECT_TRUE(Voxelize(*stub_, spec, SphereBytes()).status.ok());
    EXPECT_EQ(Voxelize(*stub_, spec, "").status.error_code(), grpc::StatusCode::NOT_FOUND);
  }
  v1::PutMeshResponse response;
  const grpc::Status refused = PutMesh(*stub_, WholeMesh(SphereBytes()), response);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(ErrorInfoOf(refused).metadata().at("limit_name"), "mesh_store_bytes");
}

TEST_F(ResumeTest, RefusesAMeshUnderAnothersDigest) {
  Start();
  const std::string other = EncodeDraco(Sphere(9), {});
  v1::PutMeshResponse response;
  std::vector<v1::PutMeshRequest> messages = WholeMesh(other);
  messages[0] = PutSpec(Sha256(SphereBytes()), other.size());
  EXPECT_EQ(PutMesh(*stub_, messages, response).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Voxelize(*stub_, SpecOfKept(20, SphereBytes()), other).status.error_code(),
            grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(Voxelize(*stub_, SpecOfKept(20, SphereBytes()), "").status.error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(ResumeTest, RefusesEveryOtherFormOfPutMesh) {
  options_.limits.max_mesh_bytes = 1 << 20;
  Start();
  v1::PutMeshRequest piece;
  piece.set_mesh_piece("abc");
  const std::string digest = Sha256("abc");
  struct Case {
    std::vector<v1::PutMeshRequest> messages;
    std::string message;
    grpc::StatusCode code = grpc::StatusCode::INVALID_ARGUMENT;
  };
  const std::vector<Case> cases = {
      {{}, "ended before spec"},
      {{v1::PutMeshRequest()}, "neither spec nor mesh_piece"},
      {{piece}, "mesh_piece came before spec"},
      {{PutSpec(digest, 3), PutSpec(digest, 3)}, "a second one came"},
      {{PutSpec("short", 3), piece}, "mesh_sha256 has 5 bytes, not 32"},
      {{PutSpec(digest, 0), piece}, "mesh_bytes 0 is below 1"},
      {{PutSpec(digest, 4), piece}, "only 3 bytes came"},
      {{PutSpec(digest, 2), piece}, "at least 3 bytes came"},
      {{PutSpec(digest, (1 << 20) + 1)}, "exceeds 1048576", grpc::StatusCode::RESOURCE_EXHAUSTED},
  };
  for (const Case& bad : cases) {
    v1::PutMeshResponse response;
    const grpc::Status status = PutMesh(*stub_, bad.messages, response);
    EXPECT_EQ(status.error_code(), bad.code) << bad.message;
    EXPECT_THAT(status.error_message(), HasSubstr(bad.message));
  }
  EXPECT_TRUE(Eventually([&] { return server_->calls() == 0; }));
}

Vec3i TileOf(const v1::BrickBatch& batch, int brick) {
  return {batch.brick_ijk(3 * brick) >> 3, batch.brick_ijk(3 * brick + 1) >> 3, batch.brick_ijk(3 * brick + 2) >> 3};
}

// After each batch of a stream, what a second request for the rest adds makes the whole; with verification, too.
TEST_F(ResumeTest, TheRestOfAStreamCompletesIt) {
  Start();
  for (const bool verify : {false, true}) {
    v1::VoxelizeSpec spec = SpecOfKept(300, SphereBytes());
    spec.set_verify(verify);
    const Answer whole = Voxelize(*stub_, spec, SphereBytes());
    ASSERT_TRUE(whole.status.ok()) << whole.status.error_message();
    ASSERT_GT(whole.messages.size(), 4U);
    Digest digest;
    uint64_t voxels = 0;
    std::set<Vec3i> tiles;
    size_t batches = 0;
    for (const v1::VoxelizeResponse& message : whole.messages) {
      if (!message.has_bricks()) continue;
      const int bricks = message.bricks().brick_ijk_size() / 3;
      for (int n = 0; n < bricks; ++n) {
        Brick brick;
        for (int m = 0; m < 3; ++m) brick.brick_ijk[static_cast<size_t>(m)] = message.bricks().brick_ijk(3 * n + m);
        std::memcpy(brick.mask.data(), message.bricks().masks().data() + n * sizeof(BrickMask), sizeof(BrickMask));
        digest.Add(brick);
        voxels += CountVoxels(brick.mask);
        tiles.insert(TileOf(message.bricks(), n));
      }
      if (verify && batches++ % 4 != 1) continue;  // verification takes its time
      const Vec3i last = TileOf(message.bricks(), bricks - 1);
      v1::VoxelizeSpec rest_spec = spec;
      rest_spec.mutable_resume_after()->set_i(last[0]);
      rest_spec.mutable_resume_after()->set_j(last[1]);
      rest_spec.mutable_resume_after()->set_k(last[2]);
      const Answer rest = Voxelize(*stub_, rest_spec, "");
      ASSERT_TRUE(rest.status.ok()) << rest.status.error_message();
      Digest sum = digest;
      for (const Brick& brick : rest.Bricks()) sum.Add(brick);
      EXPECT_EQ(sum.ToHex(), whole.summary().certificate().digest());
      EXPECT_EQ(voxels + rest.summary().voxels(), whole.summary().voxels());
      EXPECT_EQ(tiles.size() + rest.summary().tiles(), whole.summary().tiles());
      EXPECT_EQ(rest.summary().certificate().verified(), verify);
      EXPECT_EQ(rest.summary().certificate().redundant(), 0);
      EXPECT_EQ(rest.accepted().grid().SerializeAsString(), whole.accepted().grid().SerializeAsString());
    }
  }
}

TEST_F(ResumeTest, RefusesToResumeAfterATileThatIsNotItsOwn) {
  Start();
  for (const bool verify : {false, true}) {
    v1::VoxelizeSpec spec = Spec(20);
    spec.set_verify(verify);
    spec.mutable_resume_after()->set_j(-2000000000);
    const Answer answer = Voxelize(*stub_, spec, SphereBytes());
    EXPECT_EQ(answer.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_THAT(answer.status.error_message(), HasSubstr("resume_after: tile 0,-2000000000,0 does not meet"));
  }
}

TEST_F(ResumeTest, GivesUpAClientThatSendsAByteNowAndThen) {
  options_.stall_timeout = absl::Seconds(1);
  StartPatient();
  VoxelizeCall trickle(*stub_);
  trickle.Send(SpecMessage(Spec(9)));
  EXPECT_TRUE(Eventually([&] {
    trickle.Send(PieceMessage("x"));
    return server_->calls() == 0;
  }));
  EXPECT_EQ(trickle.Receive().status.error_message(), "the client has sent and taken next to nothing for 1s");
}

// With a stall timeout that is longer than the test.
TEST_F(ResumeTest, ClientsThatDoNotReadLoseTheirMemoryWhenOthersNeedIt) {
  options_.memory_bytes = uint64_t{300} << 20;
  options_.limits.max_queued_jobs = 100;
  StartPatient();
  std::vector<std::unique_ptr<VoxelizeCall>> stopped;
  const auto is_full = [&] {
    const grpc::Status status = Voxelize(*stub_, Spec(20), SphereBytes()).status;
    return status.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED;
  };
  for (int n = 0; n < 40 && !is_full(); ++n) {
    stopped.push_back(std::make_unique<VoxelizeCall>(*stub_));
    StartBigJob(*stopped.back());
  }
  ASSERT_LT(stopped.size(), 40U);
  EXPECT_TRUE(Eventually([&] { return Voxelize(*stub_, Spec(20), SphereBytes()).status.ok(); }));
  int given_up = 0;
  for (const auto& call : stopped) given_up += call->Receive().status.error_code() == grpc::StatusCode::UNAVAILABLE;
  EXPECT_GT(given_up, 0);
}

TEST_F(ResumeTest, GivesUpClientsThatStopToSendOrToRead) {
  options_.stall_timeout = absl::Seconds(1);
  StartPatient();
  VoxelizeCall silent(*stub_), stopped(*stub_);
  silent.Send(SpecMessage(Spec(9)));
  ASSERT_TRUE(Eventually([&] { return server_->calls() == 1; }));
  StartBigJob(stopped);
  EXPECT_TRUE(Eventually([&] { return server_->calls() == 0; }));
  for (VoxelizeCall* call : {&silent, &stopped}) {
    const grpc::Status status = call->Receive().status;
    EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAVAILABLE);
    EXPECT_EQ(status.error_message(), "the client has sent and taken next to nothing for 1s");
  }
}

TEST_F(ResumeTest, HoldsAJobAgainstTheMemoryBudget) {
  options_.memory_bytes = uint64_t{300} << 20;
  StartPatient();
  v1::VoxelizeSpec spec = Spec(20);
  spec.set_mesh_bytes(uint64_t{900} << 20);
  const Answer large = Voxelize(*stub_, spec, "");
  EXPECT_EQ(large.status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(large.status.error_message(), HasSubstr("memory 943718400 exceeds "));
  EXPECT_EQ(large.trailer("grpc-retry-pushback-ms"), "-1");

  // Announced bytes are not reserved; received bytes are.
  constexpr uint64_t kPiece = 1 << 20, kSent = 59 * kPiece;
  VoxelizeCall holder(*stub_), other(*stub_);
  spec.set_mesh_bytes(kSent + 1);
  holder.Send(SpecMessage(spec));
  other.Send(SpecMessage(spec));
  ASSERT_TRUE(Eventually([&] { return server_->calls() == 2; }));
  EXPECT_EQ(server_->reserved_memory(), 0);
  // Piece by piece, because gRPC holds few received bytes with such a budget.
  const auto send = [&](VoxelizeCall& call, uint64_t before) {
    for (uint64_t sent = kPiece; sent <= kSent && server_->calls() == 2; sent += kPiece) {
      call.Send(PieceMessage(std::string(kPiece, 'x')));
      ASSERT_TRUE(Eventually([&] { return server_->reserved_memory() == before + sent || server_->calls() < 2; }));
    }
  };
  send(holder, 0);
  EXPECT_EQ(server_->reserved_memory(), kSent);
  send(other, kSent);
  const Answer busy = other.Receive();
  EXPECT_EQ(busy.status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(busy.status.error_message(), HasSubstr("try again"));
  EXPECT_EQ(busy.trailer("grpc-retry-pushback-ms"), "1000");
}

// A thesis's algorithm computes the whole, whatever the region; brute force looks at the triangles' boxes.
TEST_F(ResumeTest, HoldsTheThesissAlgorithmsAgainstAllThatTheyCompute) {
  Start();
  v1::VoxelizeSpec spec = Spec(65536);
  spec.mutable_region()->mutable_max()->set_i(1);
  spec.mutable_region()->mutable_max()->set_j(1);
  spec.mutable_region()->mutable_max()->set_k(1);
  for (const v1::Algorithm algorithm : {v1::ALGORITHM_BRUTE_FORCE, v1::ALGORITHM_INCREMENTAL}) {
    spec.set_algorithm(algorithm);
    EXPECT_EQ(Voxelize(*stub_, spec, SphereBytes()).status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  }
}

TEST_F(ResumeTest, HoldsAJobAgainstItsEstimatedVoxels) {
  options_.limits.max_visited_points = 10000;
  Start();
  EXPECT_TRUE(Voxelize(*stub_, Spec(20), SphereBytes()).status.ok());
  const Answer answer = Voxelize(*stub_, Spec(100), SphereBytes());
  EXPECT_EQ(answer.status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(answer.status.error_message(), HasSubstr("visited_points (estimated) "));
  EXPECT_EQ(answer.trailer("grpc-retry-pushback-ms"), "-1");
  v1::VoxelizeSpec part = Spec(100);
  part.mutable_region()->mutable_max()->set_i(20);
  part.mutable_region()->mutable_max()->set_j(20);
  part.mutable_region()->mutable_max()->set_k(20);
  EXPECT_TRUE(Voxelize(*stub_, part, SphereBytes()).status.ok()) << "a small part of it";
  part.clear_region();
  part.mutable_bounds()->mutable_min();
  part.mutable_bounds()->mutable_max()->set_x(0.01);
  EXPECT_TRUE(Voxelize(*stub_, part, SphereBytes()).status.ok()) << "another one";
}

}  // namespace
}  // namespace latvox
