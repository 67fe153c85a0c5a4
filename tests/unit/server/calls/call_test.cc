// Whole calls through a real channel: what is sent, and what comes.
#include <gmock/gmock.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <tuple>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/brick/brick.h"
#include "core/voxelizer/digest.h"
#include "latvox/v1/voxelizer.grpc.pb.h"
#include "tests/unit/server/calls.h"
#include "tests/unit/server/error_details.h"

namespace latvox {
namespace {

using ::testing::HasSubstr;
TEST_F(ServerTest, AnswersWithAcceptedThenBricksThenSummary) {
  Start();
  const Answer answer = Voxelize(*stub_, Spec(200), SphereBytes());
  ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
  ASSERT_GE(answer.messages.size(), 3);
  double progress = 0;
  for (size_t n = 0; n < answer.messages.size(); ++n) {
    const v1::VoxelizeResponse& message = answer.messages[n];
    EXPECT_EQ(message.has_accepted(), n == 0);
    EXPECT_EQ(message.has_summary(), n + 1 == answer.messages.size());
    if (!message.has_bricks()) continue;
    EXPECT_GE(message.bricks().progress(), progress);
    progress = message.bricks().progress();
  }
  EXPECT_FALSE(answer.accepted().request_id().empty());
  EXPECT_EQ(answer.accepted().mesh().quantization_bits(), 14);
  EXPECT_EQ(answer.summary().mesh_bytes(), SphereBytes().size());
}

TEST_F(ServerTest, SummaryCountsAndDigestAreThoseOfTheBricksSent) {
  Start();
  for (const auto lattice :
       {v1::NAMED_LATTICE_CARTESIAN, v1::NAMED_LATTICE_BCC, v1::NAMED_LATTICE_FCC, v1::NAMED_LATTICE_HEXAGONAL}) {
    const Answer answer = Voxelize(*stub_, Spec(150, lattice), SphereBytes());
    ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
    uint64_t voxels = 0;
    Digest digest;
    std::set<Vec3i> tiles;
    const v1::IndexBox& box = answer.accepted().index_box();
    for (const Brick& brick : answer.Bricks()) {
      EXPECT_NE(brick.mask, BrickMask{});
      EXPECT_LE(box.min().i(), (brick.brick_ijk[0] + 1) * kBrickSide);
      EXPECT_GE(box.max().i(), brick.brick_ijk[0] * kBrickSide);
      voxels += CountVoxels(brick.mask);
      digest.Add(brick);
      tiles.insert({brick.brick_ijk[0] >> 3, brick.brick_ijk[1] >> 3, brick.brick_ijk[2] >> 3});
    }
    EXPECT_GT(voxels, 10'000);
    EXPECT_EQ(answer.summary().voxels(), voxels);
    EXPECT_EQ(answer.summary().bricks(), answer.Bricks().size());
    EXPECT_EQ(answer.summary().tiles(), tiles.size());
    EXPECT_EQ(answer.summary().certificate().digest(), digest.ToHex());
    EXPECT_TRUE(answer.summary().certificate().minimal());
  }
}

TEST_F(ServerTest, GivesTheSameBricksForAnyPiecesAndUnderLoad) {
  Start();
  const Answer first = Voxelize(*stub_, Spec(100), SphereBytes());
  ASSERT_TRUE(first.status.ok()) << first.status.error_message();
  std::vector<std::thread> clients;
  for (const size_t piece : {1u, 7u, 100u, 4096u, 1u << 20, 1u << 20, 1u << 20, 1u << 20}) {
    clients.emplace_back([&, piece] {
      const Answer answer = Voxelize(*stub_, Spec(100), SphereBytes(), piece);
      ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
      EXPECT_EQ(answer.summary().certificate().digest(), first.summary().certificate().digest());
    });
  }
  for (std::thread& client : clients) client.join();
}

TEST_F(ServerTest, VerifiesWhatItDelivers) {
  Start();
  v1::VoxelizeSpec spec = Spec(80);
  spec.set_verify(true);
  const Answer answer = Voxelize(*stub_, spec, SphereBytes());
  ASSERT_TRUE(answer.status.ok()) << answer.status.error_message();
  EXPECT_TRUE(answer.summary().certificate().verified());
  EXPECT_EQ(answer.summary().certificate().tunnels(), 0);
  EXPECT_EQ(answer.summary().certificate().redundant(), 0);
  spec.set_minimal(false);
  const Answer thick = Voxelize(*stub_, spec, SphereBytes());
  EXPECT_GT(thick.summary().certificate().redundant(), 0);
  EXPECT_FALSE(thick.summary().certificate().minimal());
}

TEST_F(ServerTest, RefusesABadSpecBeforeTheMeshIsSent) {
  Start();
  VoxelizeCall call(*stub_);
  const Answer answer = call.Send(SpecMessage(Spec(70000))).Receive();  // no half-close
  EXPECT_EQ(answer.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(answer.status.error_message(), "resolution 70000 exceeds 65536");
  const google::rpc::ErrorInfo info = ErrorInfoOf(answer.status);
  EXPECT_EQ(info.metadata().at("field"), "resolution");
  EXPECT_EQ(info.metadata().at("value"), "70000");
  EXPECT_EQ(info.metadata().at("limit"), "65536");
}

TEST_F(ServerTest, DoesNotAskToTryAgainWhatWillNeverDo) {
  options_.limits.max_visited_points = 1000;
  Start();
  v1::VoxelizeSpec unknown = Spec(9);
  unknown.set_mesh_sha256(std::string(32, 'x'));
  for (const auto& [reason, spec, mesh] :
       {std::tuple("MESH_NOT_FOUND", unknown, std::string()), std::tuple("BAD_SPEC", Spec(70000), std::string()),
        std::tuple("BAD_MESH", Spec(9), std::string("v 0 0 0\n")),
        std::tuple("BAD_STREAM", v1::VoxelizeSpec(), std::string()),
        std::tuple("LIMIT_EXCEEDED", Spec(500), SphereBytes())}) {
    VoxelizeCall call(*stub_);
    call.Send(reason == std::string("BAD_STREAM") ? PieceMessage("x") : SpecMessage(spec));
    if (!mesh.empty()) call.Send(PieceMessage(mesh));
    const Answer answer = call.HalfCloseAndReceive();
    EXPECT_EQ(ErrorInfoOf(answer.status).reason(), reason);
    EXPECT_EQ(DetailsOf(answer.status).details_size(), 1) << reason << " with RetryInfo";
    const bool exhausted = answer.status.error_code() == grpc::StatusCode::RESOURCE_EXHAUSTED;
    EXPECT_EQ(answer.trailer("grpc-retry-pushback-ms"), exhausted ? "-1" : "") << reason;
    if (!exhausted) continue;
    EXPECT_EQ(ErrorInfoOf(answer.status).metadata().at("field"), "visited_points");
    EXPECT_EQ(ErrorInfoOf(answer.status).metadata().at("limit_name"), "max_visited_points");
  }
}

TEST_F(ServerTest, EndsAJobThatHasUsedUpItsTime) {
  options_.limits.max_job_time = absl::Milliseconds(100);
  Start();
  v1::VoxelizeSpec spec = Spec(20000);
  const Answer answer = Voxelize(*stub_, spec, SphereBytes());
  EXPECT_EQ(answer.status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(answer.status.error_message(), ::testing::MatchesRegex("job_seconds 0\\.[0-9] of CPU time exceed 0\\.1"));
  EXPECT_EQ(ErrorInfoOf(answer.status).metadata().at("limit_name"), "max_job_seconds");
  EXPECT_EQ(answer.trailer("grpc-retry-pushback-ms"), "-1");
}

TEST_F(ServerTest, RefusesEveryOtherOrderOfMessages) {
  Start();
  const auto expect_refused = [](const Answer& answer, const std::string& message) {
    EXPECT_EQ(answer.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_THAT(answer.status.error_message(), HasSubstr(message));
    EXPECT_TRUE(answer.messages.empty());
  };
  expect_refused(VoxelizeCall(*stub_).HalfCloseAndReceive(), "the stream ended before spec");
  expect_refused(VoxelizeCall(*stub_).Send(PieceMessage("x")).Receive(), "mesh_piece came before spec");
  expect_refused(VoxelizeCall(*stub_).Send(SpecMessage(Spec(9))).Send(SpecMessage(Spec(9))).Receive(), "a second one");
  expect_refused(VoxelizeCall(*stub_).Send({}).Receive(), "neither spec nor mesh_piece");
  expect_refused(VoxelizeCall(*stub_).Send(SpecMessage(Spec(9))).HalfCloseAndReceive(), "mesh: no bytes came");
}

TEST_F(ServerTest, RefusesBadMeshes) {
  Start();
  const auto expect = [&](const v1::VoxelizeSpec& spec, const std::string& mesh, const std::string& message) {
    const Answer answer = Voxelize(*stub_, spec, mesh);
    EXPECT_EQ(answer.status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_THAT(answer.status.error_message(), HasSubstr(message));
  };
  expect(Spec(9), "v 0 0 0\n", "mesh: not a Draco file");
  expect(Spec(9), SphereBytes().substr(0, SphereBytes().size() / 2), "mesh: truncated or corrupt Draco data");
  expect(Spec(9), EncodeDracoPointCloud(Sphere(4)), "mesh: a Draco point cloud");
  v1::VoxelizeSpec spec = Spec(9);
  spec.set_mesh_bytes(SphereBytes().size() + 1);
  expect(spec, SphereBytes(), "was declared, but only");
  spec.set_mesh_bytes(SphereBytes().size() - 1);
  expect(spec, SphereBytes(), "was declared, but at least");
}

TEST_F(ServerTest, RefusesMoreVoxelsAlongAnAxisThanItsLimit) {
  Start();
  v1::VoxelizeSpec spec = Spec(9);
  spec.set_voxel_size(1e-6);
  const Answer answer = Voxelize(*stub_, spec, SphereBytes());
  EXPECT_EQ(answer.status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(answer.status.error_message(), HasSubstr("axis"));
  EXPECT_EQ(ErrorInfoOf(answer.status).metadata().at("limit_name"), "max_extent");
}

std::string NumberBytes(const std::vector<double>& positions, const std::vector<uint32_t>& indices) {
  return std::string(reinterpret_cast<const char*>(positions.data()), positions.size() * sizeof(double)) +
         std::string(reinterpret_cast<const char*>(indices.data()), indices.size() * sizeof(uint32_t));
}

TEST_F(ServerTest, TakesPlainArraysAndRefusesBadNumbersBeforeTheRestHasCome) {
  Start();
  v1::VoxelizeSpec spec = Spec(9);
  spec.mutable_raw_mesh()->set_vertices(3);
  spec.mutable_raw_mesh()->set_triangles(1);
  spec.mutable_raw_mesh()->set_positions(v1::POSITION_TYPE_FLOAT64);
  const Answer good = Voxelize(*stub_, spec, NumberBytes({1e7, 0, 0, 1e7 + 1, 0, 0, 1e7, 1, 0}, {0, 1, 2}));
  EXPECT_TRUE(good.status.ok()) << good.status.error_message();
  const auto refusal = [&](const std::string& bytes) {
    return VoxelizeCall(*stub_).Send(SpecMessage(spec)).Send(PieceMessage(bytes)).Receive().status.error_message();
  };
  EXPECT_EQ(refusal(NumberBytes({1, 2, HUGE_VAL}, {})), "mesh: vertex 0 is not finite");
  EXPECT_EQ(refusal(NumberBytes({1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 3})), "mesh: triangle 0 uses vertex 3 of 3");
  spec.mutable_raw_mesh()->set_triangles(0);
  EXPECT_EQ(refusal(""), "raw_mesh.triangles 0 is below 1");
  spec.mutable_raw_mesh()->set_triangles(1);
  spec.set_mesh_bytes(9);
  EXPECT_EQ(refusal(""), "mesh_bytes 9 is not 84, as raw_mesh describes");
}

TEST_F(ServerTest, HoldsMeshesAgainstItsLimits) {
  options_.limits.max_mesh_bytes = 2000;
  options_.limits.max_triangles = 100;
  Start();
  const auto expect = [&](const v1::VoxelizeSpec& spec, const std::string& mesh, const std::string& message) {
    const Answer answer = Voxelize(*stub_, spec, mesh);
    EXPECT_EQ(answer.status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
    EXPECT_THAT(answer.status.error_message(), HasSubstr(message));
    EXPECT_EQ(answer.trailer("grpc-retry-pushback-ms"), "-1");
    EXPECT_EQ(DetailsOf(answer.status).details_size(), 1) << "no RetryInfo";
    EXPECT_EQ(ErrorInfoOf(answer.status).metadata().at("limit_name"),
              message.find("triangles") == std::string::npos ? "max_mesh_bytes" : "max_triangles");
  };
  ASSERT_GT(SphereBytes().size(), 2000);
  expect(Spec(9), SphereBytes(), "mesh_bytes");
  expect(Spec(9), EncodeDraco(Sphere(8), {}), "mesh.triangles");
  v1::VoxelizeSpec spec = Spec(9);
  spec.set_mesh_bytes(3000);
  expect(spec, "", "mesh_bytes 3000 exceeds 2000");
}

TEST_F(ServerTest, TellsItsLimits) {
  options_.limits.max_jobs = 7;
  options_.build = {.commit = "abc", .libraries = {{"gRPC", "1.51.1"}}};
  Start();
  grpc::ClientContext context;
  v1::GetLimitsResponse limits;
  ASSERT_TRUE(stub_->GetLimits(&context, {}, &limits).ok());
  EXPECT_EQ(limits.max_jobs(), 7);
  EXPECT_EQ(limits.version(), LATVOX_VERSION);
  EXPECT_EQ(limits.commit(), "abc");
  ASSERT_EQ(limits.libraries_size(), 1);
  EXPECT_EQ(limits.libraries(0).name(), "gRPC");
}

// A unary call whose messages are their bytes on the wire.
std::string UnaryCall(const std::shared_ptr<grpc::Channel>& channel, const std::string& method,
                      const std::string& request) {
  grpc::GenericStub stub(channel);
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + kPatience);
  grpc::CompletionQueue queue;
  const grpc::Slice slice(request);
  const auto call = stub.PrepareUnaryCall(&context, method, grpc::ByteBuffer(&slice, 1), &queue);
  call->StartCall();
  grpc::ByteBuffer response;
  grpc::Status status;
  call->Finish(&response, &status, nullptr);
  void* tag = nullptr;
  bool ok = false;
  queue.Next(&tag, &ok);
  EXPECT_TRUE(status.ok()) << status.error_message();
  grpc::Slice whole;
  return response.DumpToSingleSlice(&whole).ok() ? std::string(whole.begin(), whole.end()) : "";
}

TEST_F(ServerTest, ReportsItsHealth) {
  Start();
  const auto channel = grpc::CreateChannel(server_->addresses()[0], grpc::InsecureChannelCredentials());
  const std::string serving("\x08\x01", 2);
  const std::string name = "latvox.v1.Voxelizer";
  EXPECT_EQ(UnaryCall(channel, "/grpc.health.v1.Health/Check", ""), serving);
  EXPECT_EQ(UnaryCall(channel, "/grpc.health.v1.Health/Check",
                      absl::StrCat("\x0a", std::string(1, static_cast<char>(name.size())), name)),
            serving);
}

TEST_F(ServerTest, ChoosesAFreePortAndReportsIt) {
  options_.listen.push_back("127.0.0.1:0");
  Start();
  ASSERT_EQ(server_->addresses().size(), 2);
  EXPECT_NE(server_->addresses()[1], "127.0.0.1:0");
  const auto stub =
      v1::Voxelizer::NewStub(grpc::CreateChannel(server_->addresses()[1], grpc::InsecureChannelCredentials()));
  EXPECT_TRUE(Voxelize(*stub, Spec(9), SphereBytes()).status.ok());
}

TEST_F(ServerTest, NamesTheAddressThatIsInUse) {
  options_.listen.push_back("127.0.0.1:0");
  Start();
  for (const std::string& address : server_->addresses()) {
    ServerOptions second;
    second.decoder = options_.decoder;
    second.listen = {"127.0.0.1:0", address};
    const auto result = VoxelServer::Start(second);
    ASSERT_FALSE(result.ok());
    EXPECT_THAT(std::string{result.status().message()}, HasSubstr("cannot listen on " + address));
  }
  EXPECT_TRUE(Voxelize(*stub_, Spec(9), SphereBytes()).status.ok());  // the first one keeps its socket
}

TEST_F(ServerTest, ReplacesSocketsOfDeadServersOnlyAndRemovesItsOwn) {
  const std::string path = directory_ / "socket";
  std::ofstream(path) << "precious";
  EXPECT_FALSE(VoxelServer::Start(options_).ok());
  EXPECT_EQ(std::filesystem::file_size(path), 8);
  std::filesystem::remove(path);
  Start();
  const std::string copy = path + "2";
  std::filesystem::rename(path, copy);  // now it looks like one left behind
  ASSERT_TRUE(server_->Stop(absl::ZeroDuration()));
  std::filesystem::rename(copy, path);
  Start();
  EXPECT_TRUE(Voxelize(*stub_, Spec(9), SphereBytes()).status.ok());
  ASSERT_TRUE(server_->Stop(absl::ZeroDuration()));
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace latvox
