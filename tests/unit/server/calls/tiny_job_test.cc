// Which thread computes a job: one of gRPC's those of some tenths of a millisecond, the queue's threads all others.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/calls/service.h"
#include "tests/unit/server/calls.h"
#include "tests/unit/server/environment.h"
#include "tests/unit/server/thread_decoder.h"

namespace latvox {
namespace {

// A server whose queue of quick work has one thread, which is busy until FreeQueue.
class BusyQueue : public testing::Test {
 protected:
  BusyQueue() {
    grpc::ServerBuilder builder;
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    stub_ = v1::Voxelizer::NewStub(server_->InProcessChannel({}));
    std::promise<void> busy;
    environment_.quick.Enqueue([&busy, freed = free_.get_future().share()] {
      busy.set_value();
      freed.wait();
    });
    busy.get_future().wait();
  }
  ~BusyQueue() override {
    FreeQueue();
    server_->Shutdown();
  }

  std::future<Answer> Send(const v1::VoxelizeSpec& spec, const std::string& mesh) {
    return std::async(std::launch::async, [=, this] { return Voxelize(*stub_, spec, mesh); });
  }

  void FreeQueue() {
    if (!std::exchange(is_free_, true)) free_.set_value();
  }

  ThreadDecoder decoder_;
  TestEnvironment environment_{decoder_, {}};
  VoxelizerService service_{environment_.shared(), environment_.everybody};
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::Voxelizer::Stub> stub_;
  std::promise<void> free_;
  bool is_free_ = false;
};

TEST_F(BusyQueue, ATinyJobDoesNotNeedIt) {
  v1::VoxelizeSpec spec = Spec(9);
  spec.mutable_raw_mesh()->set_vertices(3);
  spec.mutable_raw_mesh()->set_triangles(1);
  const std::array<float, 9> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const std::array<uint32_t, 3> corners = {0, 1, 2};
  std::string mesh(reinterpret_cast<const char*>(positions.data()), sizeof(positions));
  mesh.append(reinterpret_cast<const char*>(corners.data()), sizeof(corners));
  // A job that another program interrupts for milliseconds is no longer tiny.
  constexpr int kAttempts = 20;
  std::vector<std::future<Answer>> futures;
  bool is_answered = false;
  while (!is_answered && futures.size() < kAttempts) {
    futures.push_back(Send(spec, mesh));
    is_answered = futures.back().wait_for(kPatience / kAttempts) == std::future_status::ready;
  }
  EXPECT_TRUE(is_answered);
  FreeQueue();
  for (std::future<Answer>& future : futures) {
    const Answer answer = future.get();
    EXPECT_TRUE(answer.status.ok()) << answer.status.error_message();
    EXPECT_FALSE(answer.Bricks().empty());
  }
}

TEST_F(BusyQueue, ALongerJobWaitsForIt) {
  std::future<Answer> answer = Send(Spec(300), SphereBytes());
  EXPECT_EQ(answer.wait_for(std::chrono::milliseconds(300)), std::future_status::timeout);
  EXPECT_EQ(environment_.registry.working(), 1);
  FreeQueue();
  EXPECT_TRUE(answer.get().status.ok());
}

}  // namespace
}  // namespace latvox
