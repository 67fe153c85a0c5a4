// Calls that stall, are cancelled, run out of time, or are still there when the server stops.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <ctime>
#include <future>
#include <memory>
#include <thread>
#include <vector>

#include "core/brick/brick.h"
#include "core/voxelizer/digest.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "latvox/v1/voxelizer.grpc.pb.h"
#include "server/calls/service.h"
#include "server/decode/mesh_decoder.h"
#include "tests/unit/server/calls.h"
#include "tests/unit/server/environment.h"

namespace latvox {
namespace {

using ::testing::HasSubstr;
// Whether this process, client and server, computes nothing. Threads of lower priority may seem to while others keep
// them from the cores.
bool IsIdle() {
  const auto cpu_seconds = [] { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; };
  const double before = cpu_seconds();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  return cpu_seconds() - before < 0.01;
}

TEST_F(ServerTest, HoldsNoThreadForAClientThatStopsReadingAndEndsWithItsCancellation) {
  options_.bulk_niceness = 0;
  StartPatient();
  VoxelizeCall call(*stub_);
  StartBigJob(call);
  EXPECT_TRUE(Eventually(IsIdle));
  EXPECT_EQ(server_->calls(), 1);
  call.context().TryCancel();
  EXPECT_EQ(call.Receive().status.error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_TRUE(Eventually([&] { return server_->calls() == 0; }));
}

TEST_F(ServerTest, GoesOnWhenAClientReadsAgain) {
  options_.bulk_niceness = 0;
  StartPatient();
  VoxelizeCall call(*stub_);
  StartBigJob(call);
  EXPECT_TRUE(Eventually(IsIdle));
  const Answer rest = call.Receive();
  ASSERT_TRUE(rest.status.ok()) << rest.status.error_message();
  Digest digest;
  for (const Brick& brick : rest.Bricks()) digest.Add(brick);
  EXPECT_EQ(rest.summary().certificate().digest(), digest.ToHex());
  EXPECT_GT(rest.summary().timings().stream_ms(), 100);
}

TEST_F(ServerTest, OtherClientsAreServedWhileOneStalls) {
  Start();
  std::vector<std::unique_ptr<v1::Voxelizer::Stub>> stubs;
  std::vector<std::unique_ptr<VoxelizeCall>> stalled;
  for (int n = 0; n < 4; ++n) {
    stubs.push_back(Connect());
    stalled.push_back(std::make_unique<VoxelizeCall>(*stubs.back()));
    StartBigJob(*stalled.back());
  }
  EXPECT_TRUE(Voxelize(*stub_, Spec(50), SphereBytes()).status.ok());
  for (auto& call : stalled) {
    call->context().TryCancel();
    call->Receive();
  }
  EXPECT_TRUE(Eventually([&] { return server_->calls() == 0; }));
}

TEST_F(ServerTest, CancelsAtAnyMomentEndCleanly) {
  Start();
  for (int n = 0; n < 60; ++n) {
    VoxelizeCall call(*stub_);
    call.context().set_deadline(std::chrono::system_clock::now() + kPatience);
    std::thread canceller([&, n] {
      std::this_thread::sleep_for(std::chrono::microseconds(n * 400));
      call.context().TryCancel();
    });
    call.Send(SpecMessage(Spec(400))).Send(PieceMessage(SphereBytes()));
    const grpc::StatusCode code = call.HalfCloseAndReceive().status.error_code();
    EXPECT_TRUE(code == grpc::StatusCode::CANCELLED || code == grpc::StatusCode::OK) << code;
    canceller.join();
  }
  EXPECT_TRUE(Eventually([&] { return server_->calls() == 0; }));
}

// ThreadSanitizer sees what the server's threads share meanwhile.
TEST_F(ServerTest, CancelsDuringUploadsGiveAllMemoryBack) {
  Start();
  for (int n = 0; n < 100; ++n) {
    VoxelizeCall call(*stub_);
    std::thread canceller([&, n] {
      std::this_thread::sleep_for(std::chrono::microseconds(n * 100));
      call.context().TryCancel();
    });
    call.Send(SpecMessage(Spec(9)));
    for (int piece = 0; piece < 50; ++piece) call.Send(PieceMessage(std::string(1000, 'x')));
    EXPECT_EQ(call.Receive().status.error_code(), grpc::StatusCode::CANCELLED);
    canceller.join();
  }
  EXPECT_TRUE(Eventually([&] { return server_->calls() == 0; }));
  EXPECT_EQ(server_->reserved_memory(), 0);
}

TEST_F(ServerTest, EndsACallAtItsDeadlineInUploadAndInStream) {
  Start();
  for (const bool streaming : {false, true}) {
    VoxelizeCall call(*stub_);
    call.context().set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(800));
    if (streaming) {
      StartBigJob(call);
      std::this_thread::sleep_for(std::chrono::seconds(1));
    } else {
      call.Send(SpecMessage(Spec(9)));
    }
    EXPECT_EQ(call.Receive().status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
    EXPECT_TRUE(Eventually([&] { return server_->calls() == 0; }));
  }
}

TEST_F(ServerTest, RefusesOneJobTooManyAndSaysWhenToTryAgain) {
  options_.limits.max_jobs = 1;
  options_.limits.max_queued_jobs = 0;
  Start();
  VoxelizeCall first(*stub_);
  first.Send(SpecMessage(Spec(50)));
  ASSERT_TRUE(Eventually([&] { return server_->calls() == 1; }));
  const Answer refused = Voxelize(*stub_, Spec(50), SphereBytes());
  EXPECT_EQ(refused.status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_THAT(refused.status.error_message(), HasSubstr("jobs: 1 of 1 are in progress"));
  EXPECT_EQ(refused.trailer("grpc-retry-pushback-ms"), "1000");
  google::rpc::Status details;
  google::rpc::RetryInfo retry;
  ASSERT_TRUE(details.ParseFromString(refused.status.error_details()));
  ASSERT_EQ(details.details_size(), 2);
  ASSERT_TRUE(details.details(1).UnpackTo(&retry));
  EXPECT_EQ(retry.retry_delay().seconds(), 1);
  EXPECT_TRUE(first.Send(PieceMessage(SphereBytes())).HalfCloseAndReceive().status.ok());
}

TEST_F(ServerTest, AClientThatRunsMaxJobsAtATimeIsNeverRefused) {
  options_.limits.max_jobs = 2;
  options_.limits.max_queued_jobs = 0;
  Start();
  std::vector<std::thread> clients;
  clients.reserve(options_.limits.max_jobs);
  for (uint32_t client = 0; client < options_.limits.max_jobs; ++client) {
    clients.emplace_back([&] {
      for (int n = 0; n < 100; ++n) {
        const Answer answer = Voxelize(*stub_, Spec(n % 2 == 0 ? 4 : 70000), SphereBytes());
        EXPECT_NE(answer.status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
      }
    });
  }
  for (std::thread& client : clients) client.join();
}

TEST_F(ServerTest, LetsRunningJobsEndWithinTheGraceAndRefusesNewOnes) {
  Start();
  VoxelizeCall call(*stub_);
  call.Send(SpecMessage(Spec(50)));
  ASSERT_TRUE(Eventually([&] { return server_->calls() == 1; }));
  std::thread stopper([&] { EXPECT_TRUE(server_->Stop(absl::Seconds(20))); });
  ASSERT_TRUE(Eventually(
      [&] { return Voxelize(*stub_, Spec(4), SphereBytes()).status.error_code() == grpc::StatusCode::UNAVAILABLE; }));
  EXPECT_TRUE(call.Send(PieceMessage(SphereBytes())).HalfCloseAndReceive().status.ok());
  stopper.join();
}

TEST_F(ServerTest, StopsRunningJobsAfterTheGrace) {
  Start();
  VoxelizeCall uploading(*stub_), streaming(*stub_);
  uploading.Send(SpecMessage(Spec(50)));
  StartBigJob(streaming);
  ASSERT_TRUE(Eventually([&] { return server_->calls() == 2; }));
  std::thread reader([&] { streaming.Receive(); });
  EXPECT_TRUE(server_->Stop(absl::Milliseconds(10)));
  EXPECT_EQ(uploading.Receive().status.error_code(), grpc::StatusCode::UNAVAILABLE);
  reader.join();
}

// Never comes to an end by itself; ends a cancelled decode when it is told to.
class StuckDecoder : public MeshDecoder {
 public:
  std::shared_ptr<Decoding> Start(EncodedMesh /*mesh*/, const Limits& /*limits*/, Reserve /*reserve*/,
                                  Done done) override {
    auto decoding = std::make_shared<Stuck>();
    done_ = std::move(done);
    cancelled_ = decoding->cancelled.get_future();
    started_.set_value();
    return decoding;
  }
  void AwaitStart() { started_.get_future().wait(); }
  void AwaitCancel() { cancelled_.wait(); }
  void End() { done_(absl::CancelledError("the decode was cancelled")); }

 private:
  struct Stuck : Decoding {
    void Cancel() override {
      if (!std::exchange(told, true)) cancelled.set_value();
    }
    bool told = false;
    std::promise<void> cancelled;
  };

  std::promise<void> started_;
  std::future<void> cancelled_;
  Done done_;
};

// A service in this process, with a call that is being decoded.
struct ServiceInDecode {
  ServiceInDecode() {
    call.Send(SpecMessage(Spec(9))).Send(PieceMessage(SphereBytes())).stream().WritesDone();
    decoder.AwaitStart();
  }

  std::unique_ptr<grpc::Server> Serve() {
    grpc::ServerBuilder builder;
    builder.RegisterService(&service);
    return builder.BuildAndStart();
  }

  StuckDecoder decoder;
  TestEnvironment environment{decoder};
  VoxelizerService service{environment.shared(), environment.everybody};
  const std::unique_ptr<grpc::Server> server = Serve();
  const std::unique_ptr<v1::Voxelizer::Stub> stub = v1::Voxelizer::NewStub(server->InProcessChannel({}));
  VoxelizeCall call{*stub};
};

TEST(VoxelizerService, ACallCancelledInDecodeIsOverForTheClientAtOnceAndForTheServerAfterIt) {
  ServiceInDecode service;
  service.call.context().TryCancel();
  EXPECT_EQ(service.call.Receive().status.error_code(), grpc::StatusCode::CANCELLED);
  service.decoder.AwaitCancel();
  EXPECT_EQ(service.environment.registry.size(), 1);
  service.decoder.End();
  EXPECT_TRUE(service.environment.registry.WaitUntilEmpty(absl::FromChrono(kPatience)));
  service.server->Shutdown();
}

TEST(VoxelizerService, NoThreadOfALaneWaitsForADecode) {
  ServiceInDecode service;
  std::promise<void> other_task;
  service.environment.quick.Enqueue([&] { other_task.set_value(); });
  EXPECT_EQ(other_task.get_future().wait_for(kPatience), std::future_status::ready);
  service.environment.registry.StopAll();
  service.decoder.AwaitCancel();
  service.decoder.End();
  EXPECT_EQ(service.call.Receive().status.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_TRUE(service.environment.registry.WaitUntilEmpty(absl::FromChrono(kPatience)));
  service.server->Shutdown();
}

}  // namespace
}  // namespace latvox
