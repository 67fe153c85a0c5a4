// Whose turn it is, in whole calls: those that wait for it, and those that give it up.
#include <gmock/gmock.h>

#include <future>
#include <memory>
#include <optional>
#include <thread>
#include <utility>

#include "core/voxelizer/digest.h"
#include "server/calls/service.h"
#include "tests/unit/server/calls.h"
#include "tests/unit/server/environment.h"
#include "tests/unit/server/thread_decoder.h"

namespace latvox {
namespace {

// Keeps its first decode until it is cancelled.
class SlowAtFirstDecoder : public ThreadDecoder {
 public:
  std::shared_ptr<Decoding> Start(EncodedMesh mesh, const Limits& limits, Reserve reserve, Done done) override {
    if (std::exchange(first_over_, true))
      return ThreadDecoder::Start(std::move(mesh), limits, std::move(reserve), std::move(done));
    first_.set_value();
    return std::make_shared<Stuck>(*this, std::move(done));
  }
  void AwaitFirst() { first_.get_future().wait(); }

 private:
  struct Stuck : Decoding {
    Stuck(SlowAtFirstDecoder& its_decoder, Done to_tell) : decoder(its_decoder), done(std::move(to_tell)) {}
    void Cancel() override {
      if (!done) return;
      decoder.OnThread(
          [tell = std::exchange(done, nullptr)] { tell(absl::CancelledError("the decode was cancelled")); });
    }
    SlowAtFirstDecoder& decoder;
    Done done;
  };

  bool first_over_ = false;
  std::promise<void> first_;
};

// A server with one turn, which a call has that is being decoded.
class TakenTurn : public testing::Test {
 protected:
  TakenTurn() {
    grpc::ServerBuilder builder;
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    stub_ = v1::Voxelizer::NewStub(server_->InProcessChannel({}));
    holder_.emplace(*stub_);
    holder_->Send(SpecMessage(Spec(9))).Send(PieceMessage(SphereBytes())).stream().WritesDone();
    decoder_.AwaitFirst();
  }
  ~TakenTurn() override { server_->Shutdown(); }

  void EndHolder() {
    holder_->context().TryCancel();
    EXPECT_EQ(holder_->Receive().status.error_code(), grpc::StatusCode::CANCELLED);
  }

  SlowAtFirstDecoder decoder_;
  TestEnvironment environment_{decoder_, {.max_jobs = 1}};
  CallRegistry& registry_ = environment_.registry;
  VoxelizerService service_{environment_.shared(), environment_.everybody};
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::Voxelizer::Stub> stub_;
  std::optional<VoxelizeCall> holder_;
};

TEST_F(TakenTurn, AJobWaitsForItAndThenIsServed) {
  VoxelizeCall waiting(*stub_);
  waiting.Send(SpecMessage(Spec(20))).Send(PieceMessage(SphereBytes())).stream().WritesDone();
  ASSERT_TRUE(Eventually([&] { return registry_.size() == 2; }));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_EQ(registry_.working(), 1);
  EXPECT_EQ(registry_.queued(), 1);
  EndHolder();
  EXPECT_TRUE(waiting.Receive().status.ok());
  EXPECT_TRUE(registry_.WaitUntilEmpty(absl::FromChrono(kPatience)));
}

TEST_F(TakenTurn, APutMeshThatWaitsForItHasNotStalled) {
  v1::PutMeshResponse response;
  std::thread putter([&] { EXPECT_TRUE(PutMesh(*stub_, WholeMesh(SphereBytes()), response).ok()); });
  EXPECT_TRUE(Eventually([&] { return registry_.size() == 2; }));
  for (int n = 0; n < 30; ++n) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    registry_.EndStalled(absl::Seconds(2));
  }
  EXPECT_EQ(registry_.size(), 2);
  EndHolder();
  putter.join();
  EXPECT_TRUE(registry_.WaitUntilEmpty(absl::FromChrono(kPatience)));
}

class OneTurn : public ServerTest {
 protected:
  OneTurn() { options_.limits.max_jobs = 1; }

  // The rest of a big job, which must be what its summary says.
  static void ExpectRest(VoxelizeCall& call) {
    const Answer rest = call.Receive();
    ASSERT_TRUE(rest.status.ok()) << rest.status.error_message();
    Digest digest;
    for (const Brick& brick : rest.Bricks()) digest.Add(brick);
    EXPECT_EQ(rest.summary().certificate().digest(), digest.ToHex());
  }
};

TEST_F(OneTurn, OthersHaveTheTurnOfACallWhoseClientDoesNotRead) {
  Start();
  VoxelizeCall stopped(*stub_);
  StartBigJob(stopped);
  for (int n = 0; n < 3; ++n) EXPECT_TRUE(Voxelize(*stub_, Spec(50), SphereBytes()).status.ok());
  EXPECT_TRUE(Eventually([&] { return server_->calls() == 1; }));  // the stopped one
  ExpectRest(stopped);
}

TEST_F(OneTurn, ManyStreamsShareItAndEachIsWhole) {
  Start();
  std::vector<std::thread> readers;
  for (int n = 0; n < 3; ++n) {
    readers.emplace_back([this] {
      const auto stub = Connect();
      VoxelizeCall call(*stub);
      StartBigJob(call);
      ExpectRest(call);
    });
  }
  for (int n = 0; n < 10; ++n) EXPECT_TRUE(Voxelize(*stub_, Spec(20), SphereBytes()).status.ok());
  for (std::thread& reader : readers) reader.join();
  EXPECT_TRUE(Eventually([&] { return server_->calls() == 0; }));
}

TEST_F(OneTurn, StreamsThatHaveGivenItUpEndWithinTheGrace) {
  Start();
  VoxelizeCall first(*stub_), second(*stub_);
  StartBigJob(first);
  StartBigJob(second);
  std::thread stopper([&] { EXPECT_TRUE(server_->Stop(absl::FromChrono(kPatience))); });
  ASSERT_TRUE(Eventually(
      [&] { return Voxelize(*stub_, Spec(4), SphereBytes()).status.error_code() == grpc::StatusCode::UNAVAILABLE; }));
  ExpectRest(first);
  ExpectRest(second);
  stopper.join();
}

}  // namespace
}  // namespace latvox
