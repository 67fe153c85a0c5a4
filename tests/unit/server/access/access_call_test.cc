// Calls with and without a token, through a real channel.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "latvox/v1/voxelizer.grpc.pb.h"
#include "server/listen/server.h"
#include "tests/unit/server/calls.h"
#include "tests/unit/server/error_details.h"
#include "tests/unit/temporary_directory.h"

namespace latvox {
namespace {

constexpr char kAlice[] = "alice-0123456789", kBob[] = "bob-0123456789ab";

void ReplaceFile(const std::string& path, const std::string& text) {
  std::ofstream(path + ".new") << text;
  ASSERT_EQ(std::rename((path + ".new").c_str(), path.c_str()), 0);
}

class AccessTest : public testing::Test {
 protected:
  void SetUp() override {
    ReplaceFile(token_file_, absl::StrCat("alice ", kAlice, " max-mesh-bytes=100 max-triangles=5\n"));
    ServerOptions options;
    options.listen = {"unix:" + directory_ / "socket"};
    options.threads = 1;
    options.decoder = TestDecoders();
    options.access.token_file = token_file_;
    auto server = VoxelServer::Start(options);
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
    channel_ = grpc::CreateChannel(server_->addresses()[0], grpc::InsecureChannelCredentials());
    stub_ = v1::Voxelizer::NewStub(channel_);
  }

  static std::unique_ptr<grpc::ClientContext> Context(const std::optional<std::string>& authorization) {
    auto context = std::make_unique<grpc::ClientContext>();
    context->set_wait_for_ready(true);
    if (authorization) context->AddMetadata("authorization", *authorization);
    return context;
  }

  grpc::Status GetLimits(const std::optional<std::string>& authorization) {
    limits_.Clear();
    return stub_->GetLimits(Context(authorization).get(), {}, &limits_);
  }

  grpc::Status Pixelize(const std::optional<std::string>& authorization) {
    v1::PixelizeRequest request;
    v1::Polyline& polyline = *request.add_polylines();
    for (const double coordinate : {0.0, 0.0, 9.0, 4.0}) polyline.add_xy(coordinate);
    request.mutable_lattice()->set_named(v1::NAMED_PLANE_LATTICE_SQUARE);
    request.set_resolution(9);
    v1::PixelizeResponse response;
    return stub_->Pixelize(Context(authorization).get(), request, &response);
  }

  grpc::Status Voxelize(const std::optional<std::string>& authorization, const std::string& mesh) {
    const auto context = Context(authorization);
    const auto stream = stub_->Voxelize(context.get());
    v1::VoxelizeRequest message;
    message.mutable_spec()->mutable_lattice()->set_named(v1::NAMED_LATTICE_BCC);
    message.mutable_spec()->set_resolution(9);
    stream->Write(message);
    message.set_mesh_piece(mesh);
    stream->Write(message);
    stream->WritesDone();
    for (v1::VoxelizeResponse answer; stream->Read(&answer);) {
    }
    return stream->Finish();
  }

  const TemporaryDirectory directory_;
  const std::string token_file_ = directory_ / "tokens";
  std::unique_ptr<VoxelServer> server_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::Voxelizer::Stub> stub_;
  v1::GetLimitsResponse limits_;
};

const std::string& SmallMesh() {
  static const auto& mesh = *new std::string(EncodeDraco(Sphere(3), {}));
  return mesh;
}

TEST_F(AccessTest, EveryCallNeedsAGoodTokenAndIsNotToldWhatIsWrongWithAnother) {
  std::optional<std::string> details;
  for (const std::optional<std::string>& bad : std::vector<std::optional<std::string>>{
           std::nullopt, "", "Bearer", "Bearer ", std::string("Basic ") + kAlice, std::string("Bearer  ") + kAlice,
           std::string("Bearer ") + kAlice + "x", std::string("Bearer ") + kBob, kAlice}) {
    for (const grpc::Status& status : {GetLimits(bad), Pixelize(bad), Voxelize(bad, SmallMesh())}) {
      EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAUTHENTICATED) << bad.value_or("none");
      if (!details) details = status.error_details();
      EXPECT_EQ(status.error_details(), *details);
    }
    EXPECT_EQ(limits_.version(), "");
  }
  EXPECT_EQ(server_->calls(), 0);
  const grpc::Status unauthenticated(grpc::StatusCode::UNAUTHENTICATED, "", *details);
  EXPECT_EQ(ErrorInfoOf(unauthenticated).reason(), "UNAUTHENTICATED");
  EXPECT_EQ(DetailsOf(unauthenticated).details_size(), 1) << "no RetryInfo";

  for (const char* scheme : {"Bearer ", "bearer ", "BEARER "}) {
    EXPECT_TRUE(GetLimits(std::string(scheme) + kAlice).ok());
    EXPECT_TRUE(Pixelize(std::string(scheme) + kAlice).ok());
  }
  EXPECT_TRUE(Eventually([this] { return server_->calls() == 0; }));
}

TEST_F(AccessTest, TwoTokensInOneCallAreNone) {
  grpc::ClientContext context;
  context.AddMetadata("authorization", std::string("Bearer ") + kAlice);
  context.AddMetadata("authorization", std::string("Bearer ") + kAlice);
  EXPECT_EQ(stub_->GetLimits(&context, {}, &limits_).error_code(), grpc::StatusCode::UNAUTHENTICATED);
}

TEST_F(AccessTest, ATokensLimitsHoldForItsCallsAndAreWhatItIsTold) {
  ASSERT_TRUE(GetLimits(std::string("Bearer ") + kAlice).ok());
  EXPECT_EQ(limits_.max_mesh_bytes(), 100);
  EXPECT_EQ(limits_.max_triangles(), 5);
  EXPECT_EQ(limits_.max_vertices(), Limits().max_vertices);
  ASSERT_GT(SmallMesh().size(), 100);
  EXPECT_EQ(Voxelize(std::string("Bearer ") + kAlice, SmallMesh()).error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  ReplaceFile(token_file_, absl::StrCat("alice ", kAlice, " max-triangles=5\nbob ", kBob, "\n"));
  server_->Reload();
  const grpc::Status status = Voxelize(std::string("Bearer ") + kAlice, SmallMesh());
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(status.error_message(), testing::HasSubstr("triangles"));
  EXPECT_TRUE(Voxelize(std::string("Bearer ") + kBob, SmallMesh()).ok());
}

// A call that its client leaves open.
class OpenCall {
 public:
  OpenCall(v1::Voxelizer::Stub& stub, std::unique_ptr<grpc::ClientContext> context)
      : context_(std::move(context)), stream_(stub.Voxelize(context_.get())) {
    stream_->Write(SpecMessage(Spec(9)));
  }
  ~OpenCall() {
    context_->TryCancel();
    stream_->Finish();
  }

 private:
  const std::unique_ptr<grpc::ClientContext> context_;
  const std::unique_ptr<Stream> stream_;
};

TEST_F(AccessTest, ATokensMaxJobsHoldForItsOpenCallsAndLeaveOtherTokensAlone) {
  const std::string alice = std::string("Bearer ") + kAlice, bob = std::string("Bearer ") + kBob;
  ReplaceFile(token_file_, absl::StrCat("alice ", kAlice, " max-jobs=2\nbob ", kBob, "\n"));
  server_->Reload();
  ASSERT_TRUE(GetLimits(alice).ok());
  EXPECT_EQ(limits_.max_jobs_per_client(), 2);
  std::optional<OpenCall> first(std::in_place, *stub_, Context(alice)), second(std::in_place, *stub_, Context(alice));
  ASSERT_TRUE(Eventually([this] { return server_->calls() == 2; }));

  const grpc::Status refused = Voxelize(alice, SmallMesh());
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  const google::rpc::ErrorInfo info = ErrorInfoOf(refused);
  EXPECT_EQ(info.reason(), "TOO_MANY_JOBS_OF_CLIENT");
  EXPECT_EQ(info.metadata().at("limit"), "2");
  EXPECT_EQ(info.metadata().at("limit_name"), "max_jobs_per_client");
  google::rpc::RetryInfo retry;
  ASSERT_EQ(DetailsOf(refused).details_size(), 2);
  ASSERT_TRUE(DetailsOf(refused).details(1).UnpackTo(&retry));
  EXPECT_EQ(retry.retry_delay().seconds(), 1);
  EXPECT_EQ(ErrorInfoOf(Pixelize(alice)).reason(), "TOO_MANY_JOBS_OF_CLIENT") << "of any method";
  EXPECT_TRUE(Voxelize(bob, SmallMesh()).ok());
  EXPECT_TRUE(GetLimits(alice).ok()) << "takes no place";

  first.reset();
  ASSERT_TRUE(Eventually([this] { return server_->calls() == 1; }));
  EXPECT_TRUE(Voxelize(alice, SmallMesh()).ok());
}

TEST_F(AccessTest, AChangedFileHoldsSoonAndABrokenOneNever) {
  const std::string alice = std::string("Bearer ") + kAlice, bob = std::string("Bearer ") + kBob;
  EXPECT_FALSE(GetLimits(bob).ok());
  ReplaceFile(token_file_, absl::StrCat("bob ", kBob, "\n"));  // no signal, no Reload
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!GetLimits(bob).ok() && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  EXPECT_TRUE(GetLimits(bob).ok());
  EXPECT_FALSE(GetLimits(alice).ok());
  for (const std::string& broken : {std::string(), absl::StrCat("alice ", kAlice, "\nnonsense\n")}) {
    ReplaceFile(token_file_, broken);
    server_->Reload();
    EXPECT_TRUE(GetLimits(bob).ok());
    EXPECT_FALSE(GetLimits(alice).ok());
  }
  unlink(token_file_.c_str());
  server_->Reload();
  EXPECT_TRUE(GetLimits(bob).ok());
}

TEST_F(AccessTest, AServerDoesNotStartWithAFileThatIsWrong) {
  ServerOptions options;
  options.decoder = TestDecoders();
  options.listen = {"unix:" + token_file_ + ".socket"};
  options.access.token_file = token_file_ + ".missing";
  options.decoder.program = LATVOXD;
  const auto server = VoxelServer::Start(options);
  EXPECT_EQ(server.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(server.status().message()), testing::HasSubstr(options.access.token_file));
  EXPECT_EQ(VoxelServer::Check(options), server.status());
}

TEST_F(AccessTest, ATraceparentIsAnsweredWithTheSameTraceAndASpanOfOurs) {
  const std::string trace = "4bf92f3577b34da6a3ce929d0e0e4736";
  for (const bool good : {true, false}) {
    const auto context = Context(std::string("Bearer ") + kAlice);
    context->AddMetadata("traceparent", "00-" + trace + (good ? "-00f067aa0ba902b7-01" : "-00f067aa0ba902b7"));
    ASSERT_TRUE(stub_->GetLimits(context.get(), {}, &limits_).ok());
    const auto& metadata = context->GetServerInitialMetadata();
    const auto found = metadata.find("traceparent");
    ASSERT_EQ(found != metadata.end(), good);
    if (!good) continue;
    const std::string answer(found->second.data(), found->second.size());
    EXPECT_EQ(answer.substr(0, 36), "00-" + trace + "-");
    EXPECT_EQ(answer.substr(52), "-01");
    EXPECT_NE(answer.substr(36, 16), "00f067aa0ba902b7");
  }
}

}  // namespace
}  // namespace latvox
