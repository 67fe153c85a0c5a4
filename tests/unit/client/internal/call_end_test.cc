// The ends of calls: errors and their details, cancellation, deadlines, servers that go away.
#include <gmock/gmock.h>

#include <atomic>
#include <thread>

#include "client/internal/printable.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "latvox/error.h"
#include "tests/unit/client/fake_server.h"

namespace latvox::client {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

grpc::Status Detailed() {
  google::rpc::ErrorInfo info;
  info.set_reason("MESH_TOO_LARGE");
  info.set_domain("latvox");
  (*info.mutable_metadata())["field"] = "mesh_bytes";
  (*info.mutable_metadata())["value"] = "3000000";
  (*info.mutable_metadata())["limit"] = "1000";
  google::rpc::RetryInfo retry;
  retry.mutable_retry_delay()->set_seconds(2);
  retry.mutable_retry_delay()->set_nanos(500000000);
  google::rpc::Status status;
  status.add_details()->PackFrom(info);
  status.add_details()->PackFrom(retry);
  return {grpc::StatusCode::RESOURCE_EXHAUSTED, "mesh_bytes 3000000 exceeds 1000", status.SerializeAsString()};
}

CallOptions OneTry() {
  CallOptions options;
  options.retry.max_retries = 0;
  return options;
}

TEST(Call, ErrorsCarryTheServersDetails) {
  const Fake fake([](grpc::ServerContext*, Stream*) { return Detailed(); });
  const absl::Status status = fake.client().Voxelize({}, kMesh, {}, OneTry()).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(status.message(), "mesh_bytes 3000000 exceeds 1000");
  const ErrorDetails details = GetErrorDetails(status);
  EXPECT_EQ(details.reason, "MESH_TOO_LARGE");
  EXPECT_EQ(details.field, "mesh_bytes");
  EXPECT_EQ(details.value, "3000000");
  EXPECT_EQ(details.limit, "1000");
  EXPECT_EQ(details.retry_after, absl::Milliseconds(2500));
}

TEST(Call, ErrorsPrintReadablyWithTheirDetails) {
  const Fake fake([](grpc::ServerContext*, Stream*) { return Detailed(); });
  const std::string printed = fake.client().Voxelize({}, kMesh, {}, OneTry()).status().ToString();
  EXPECT_THAT(printed, StartsWith("RESOURCE_EXHAUSTED: mesh_bytes 3000000 exceeds 1000 ["));
  for (const char* detail :
       {"reason='MESH_TOO_LARGE'", "field='mesh_bytes'", "value='3000000'", "limit='1000'", "retry_after='2.5s'"}) {
    EXPECT_THAT(printed, HasSubstr(absl::StrCat("[latvox.", detail, "]")));
  }
}

TEST(Call, ErrorsOfAServerThatSendsBinaryTextArePrintable) {
  const std::string binary("\0\x1b[2J\r\n\xff\x80", 9);
  google::rpc::ErrorInfo info;
  info.set_reason("\x01");
  (*info.mutable_metadata())["value"] = "\x1b[2J";
  google::rpc::Status details;
  details.add_details()->PackFrom(info);
  const Fake fake([&](grpc::ServerContext*, Stream*) {
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "no: " + binary, details.SerializeAsString());
  });
  CallOptions twice = OneTry();
  for (const int retries : {0, 1}) {
    twice.retry.max_retries = retries;
    const absl::Status status = fake.client().Voxelize({}, kMesh, {}, twice).status();
    EXPECT_THAT(std::string(status.message()), StartsWith("no: \\x00\\x1b[2J\\r\\n\\xff\\x80"));
    EXPECT_EQ(GetErrorDetails(status).value, "\x1b[2J");
    EXPECT_EQ(Printable(status.ToString()), status.ToString());
  }
}

TEST(Call, GarbageInTheDetailsLeavesTheErrorItself) {
  const Fake fake([](grpc::ServerContext*, Stream*) {
    return grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, "no", "\xFF\xFF\xFF garbage");
  });
  const absl::Status status = fake.client().Voxelize({}, kMesh, {}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(GetErrorDetails(status).reason, "");
}

TEST(Call, AnEarlyErrorEndsALargeUpload) {
  const Fake fake([](grpc::ServerContext*, Stream* stream) {
    v1::VoxelizeRequest request;
    stream->Read(&request);
    return Detailed();  // leaves 200 MB unread
  });
  const std::string mesh(200000000, 'm');
  const absl::Time start = absl::Now();
  EXPECT_EQ(fake.client().Voxelize({}, mesh, {}, OneTry()).status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_LT(absl::Now() - start, absl::Seconds(5));
}

TEST(Call, AnswersAreReadWhileTheUploadStillRuns) {
  // This server reads no further piece before the client has read its answers. 40 MB exceed any window.
  const std::string mesh(40000000, 'm');
  std::atomic<int> batches = 0;
  const Fake fake([&](grpc::ServerContext*, Stream* stream) {
    Answers answers(mesh.size());
    v1::VoxelizeRequest request;
    stream->Read(&request);
    stream->Write(answers.accepted);
    v1::VoxelizeResponse nothing;
    nothing.mutable_bricks();
    for (int n = 0; n < 200000; ++n) stream->Write(nothing);
    while (stream->Read(&request)) continue;
    for (const auto& answer : {answers.first, answers.second, answers.summary}) stream->Write(answer);
    return grpc::Status::OK;
  });
  VoxelizeHandlers handlers;
  handlers.on_bricks = [&](const BrickBatch&) { return ++batches, absl::OkStatus(); };
  const auto summary = fake.client().Voxelize({}, mesh, handlers);
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_EQ(batches, 200002);
}

// Sends Accepted and then nothing until the call is over.
grpc::Status Hang(grpc::ServerContext* context, Stream* stream) {
  stream->Write(Answers(0).accepted);
  while (!context->IsCancelled()) absl::SleepFor(absl::Milliseconds(1));
  return grpc::Status::CANCELLED;
}

TEST(Call, CancellingFromAnotherThreadEndsIt) {
  const Fake fake(Hang);
  CallOptions options;
  std::thread canceller([cancellation = options.cancellation] {
    absl::SleepFor(absl::Milliseconds(50));
    cancellation.Cancel();
  });
  const absl::Status status = fake.client().Voxelize({}, kMesh, {}, options).status();
  canceller.join();
  EXPECT_EQ(status.code(), absl::StatusCode::kCancelled) << status;
}

TEST(Call, CancellingFromACallbackEndsIt) {
  const Fake fake(Hang);
  CallOptions options;
  VoxelizeHandlers handlers;
  handlers.on_accepted = [&](const Accepted&) { return options.cancellation.Cancel(), absl::OkStatus(); };
  EXPECT_EQ(fake.client().Voxelize({}, kMesh, handlers, options).status().code(), absl::StatusCode::kCancelled);
}

TEST(Call, CancellingBeforehandSendsNothing) {
  std::atomic<int> calls = 0;
  const Fake fake([&](grpc::ServerContext*, Stream*) { return ++calls, grpc::Status::OK; });
  CallOptions options;
  options.cancellation.Cancel();
  EXPECT_EQ(fake.client().Voxelize({}, kMesh, {}, options).status().code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(calls, 0);
}

TEST(Call, AnErrorOfACallbackEndsItAndIsReturned) {
  const Fake fake(Hang);
  VoxelizeHandlers handlers;
  handlers.on_accepted = [](const Accepted&) { return absl::DataLossError("the disk is full"); };
  EXPECT_EQ(fake.client().Voxelize({}, kMesh, handlers).status(), absl::DataLossError("the disk is full"));
}

TEST(Call, TheDeadlineEndsIt) {
  const Fake fake(Hang);
  CallOptions options;
  options.deadline = absl::Now() + absl::Milliseconds(100);
  EXPECT_EQ(fake.client().Voxelize({}, kMesh, {}, options).status().code(), absl::StatusCode::kDeadlineExceeded);
}

TEST(Call, AServerThatGoesAwayIsUnavailable) {
  std::optional<Fake> fake;
  fake.emplace([&](grpc::ServerContext* context, Stream* stream) {
    Hang(context, stream);
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "shutting down");
  });
  std::thread stopper([&] {
    absl::SleepFor(absl::Milliseconds(50));
    fake->server().Shutdown(std::chrono::system_clock::now());
  });
  EXPECT_EQ(fake->client().Voxelize({}, kMesh, {}, OneTry()).status().code(), absl::StatusCode::kUnavailable);
  stopper.join();
}

TEST(Call, ManyThreadsShareOneClient) {
  const Fake fake(Send(Answers(kMesh.size()).All()));
  std::vector<std::thread> threads;
  for (int n = 0; n < 8; ++n) {
    threads.emplace_back([&] { EXPECT_TRUE(fake.client().Voxelize({}, kMesh, {}).ok()); });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST(Connection, LimitsAndHealthAreAsTheServerSays) {
  Fake fake(Hang);
  const auto limits = fake.client().GetLimits();
  ASSERT_TRUE(limits.ok()) << limits.status();
  EXPECT_EQ(limits->max_extent, 65536u);
  EXPECT_EQ(limits->version, "fake");
  EXPECT_EQ(limits->commit, "abc");
  ASSERT_EQ(limits->libraries.size(), 1u);
  EXPECT_EQ(limits->libraries[0].name + " " + limits->libraries[0].version, "gRPC 1.51.1");
  auto healthy = fake.client().Health();
  ASSERT_TRUE(healthy.ok()) << healthy.status();
  EXPECT_TRUE(*healthy);
  fake.server().GetHealthCheckService()->SetServingStatus(false);
  healthy = fake.client().Health();
  ASSERT_TRUE(healthy.ok()) << healthy.status();
  EXPECT_FALSE(*healthy);
}

TEST(Connection, RefusedIsUnavailableAtOnceAndNamesTheAddress) {
  for (const std::string address : {"127.0.0.1:1", "unix:/nonexistent/socket"}) {
    const absl::Time start = absl::Now();
    const auto client = Client::Connect(address);
    EXPECT_EQ(client.status().code(), absl::StatusCode::kUnavailable);
    EXPECT_THAT(std::string(client.status().message()), HasSubstr(address));
    EXPECT_LT(absl::Now() - start, absl::Seconds(5));
  }
}

TEST(CancellationHandle, RunsEachSubscriptionOnceAndNoneAfterItIsGone) {
  const Cancellation cancellation, copy = cancellation;
  int gone = 0, there = 0, late = 0;
  {
    const Cancellation::Subscription subscription(cancellation, [&] { ++gone; });
  }
  const Cancellation::Subscription early(copy, [&] { ++there; });
  EXPECT_FALSE(cancellation.cancelled());
  copy.Cancel();
  cancellation.Cancel();
  const Cancellation::Subscription after(cancellation, [&] { ++late; });
  EXPECT_TRUE(cancellation.cancelled());
  EXPECT_EQ(gone, 0);
  EXPECT_EQ(there, 1);
  EXPECT_EQ(late, 1);
}

}  // namespace
}  // namespace latvox::client
