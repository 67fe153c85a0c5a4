// Retries of calls: when, where, and until when; and meshes that servers store.
#include <gmock/gmock.h>

#include <thread>

#include "absl/strings/escaping.h"
#include "absl/time/clock.h"
#include "latvox/client.h"
#include "latvox/error.h"
#include "tests/unit/client/model_server.h"

namespace latvox::client {
namespace {

using testing::HasSubstr;
using At = Fault::At;

const std::string kMesh(3000000, 'm');

CallOptions Fast(int retries = 5) {
  CallOptions options;
  options.retry = {retries, absl::Milliseconds(1), absl::Milliseconds(20)};
  return options;
}

Client ConnectTo(const std::string& addresses) {
  absl::StatusOr<Client> client = Client::Connect(addresses);
  EXPECT_TRUE(client.ok()) << client.status();
  return *std::move(client);
}

grpc::Status Full(absl::Duration retry_after) {
  return ServerSays(grpc::StatusCode::RESOURCE_EXHAUSTED, "full", retry_after);
}

TEST(Retry, AFullServerIsAskedAgainWhenItSaysSoAndNotBefore) {
  ModelServer server({{At::kStart, 0, Full(absl::Milliseconds(200))}});
  const absl::Time start = absl::Now();
  const auto summary = ConnectTo(server.address()).Voxelize({}, kMesh, {}, Fast());
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_GE(absl::Now() - start, absl::Milliseconds(200));
  EXPECT_EQ(summary->resumed, 0);
  EXPECT_EQ(server.calls().size(), 2u);
}

TEST(Retry, ThePushbackOfTheTrailerCounts) {
  const grpc::Status broken = BrokenConnection();
  ModelServer server({{At::kStart, 0, broken, "150"}, {At::kStart, 0, broken, "-1"}});
  const absl::Time start = absl::Now();
  const auto status = ConnectTo(server.address()).Voxelize({}, kMesh, {}, Fast()).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable) << "-1: never again";
  EXPECT_GE(absl::Now() - start, absl::Milliseconds(150));
  EXPECT_EQ(server.calls().size(), 2u);
}

TEST(Retry, ARefusalForGoodIsFinal) {
  ModelServer server({{At::kStart, 0, Full(absl::InfiniteDuration())}});
  const auto status = ConnectTo(server.address()).Voxelize({}, kMesh, {}, Fast()).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(server.calls().size(), 1u);
}

TEST(Retry, TheLastErrorKeepsItsDetailsAndTellsOfTheOthers) {
  ModelServer server(std::deque<Fault>(9, Fault{At::kStart, 0, Full(absl::Milliseconds(2))}));
  const auto status = ConnectTo(server.address()).Voxelize({}, kMesh, {}, Fast(3)).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(status.message(), "full (the last of 4 tries)");
  EXPECT_EQ(GetErrorDetails(status).retry_after, absl::Milliseconds(2));
  EXPECT_EQ(server.calls().size(), 4u);
}

TEST(Retry, EveryCallIsTriedAgain) {
  ModelServer server;
  const Client client = ConnectTo(server.address());
  server.Refuse(2, BrokenConnection());
  EXPECT_TRUE(client.GetLimits(Fast()).ok());
  EXPECT_EQ(server.refusals_left(), 0);
  server.Refuse(2, Full(absl::Milliseconds(1)));
  EXPECT_TRUE(client.Pixelize({}, Fast()).ok());
  EXPECT_EQ(server.refusals_left(), 0);
  server.Refuse(2, BrokenConnection());
  EXPECT_TRUE(client.PutMesh(kMesh, Fast()).ok());
  EXPECT_EQ(server.refusals_left(), 0);
  server.Refuse(2, BrokenConnection());
  EXPECT_EQ(client.GetLimits(Fast(1)).status().code(), absl::StatusCode::kUnavailable);
  server.Refuse(2, ServerSays(grpc::StatusCode::INVALID_ARGUMENT, "no"));
  EXPECT_EQ(client.Pixelize({}, Fast()).status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(server.refusals_left(), 1);
}

TEST(Retry, TheDeadlineIsThatOfAllTries) {
  ModelServer server(std::deque<Fault>(1000, Fault{At::kStart, 0, BrokenConnection()}));
  CallOptions options = Fast(1000);
  const absl::Time start = absl::Now();
  options.deadline = start + absl::Milliseconds(300);
  const auto status = ConnectTo(server.address()).Voxelize({}, kMesh, {}, options).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kDeadlineExceeded) << status;
  EXPECT_LT(absl::Now() - start, absl::Seconds(2));
  EXPECT_GT(server.calls().size(), 3u);
}

TEST(Retry, AWaitThatWouldPassTheDeadlineIsNotWaited) {
  ModelServer server({{At::kStart, 0, Full(absl::Milliseconds(900))}});
  CallOptions options = Fast();
  const absl::Time start = absl::Now();
  options.deadline = start + absl::Milliseconds(600);
  const auto status = ConnectTo(server.address()).Voxelize({}, kMesh, {}, options).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kDeadlineExceeded) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr("full"));
  EXPECT_LT(absl::Now() - start, absl::Milliseconds(500));
}

TEST(Retry, CancellingEndsTheWaitAtOnce) {
  ModelServer server(std::deque<Fault>(9, Fault{At::kStart, 0, BrokenConnection(), "60000"}));
  CallOptions options = Fast();
  std::thread canceller([&server, cancellation = options.cancellation] {
    while (server.calls().empty()) absl::SleepFor(absl::Milliseconds(1));
    absl::SleepFor(absl::Milliseconds(50));
    cancellation.Cancel();
  });
  const absl::Time start = absl::Now();
  const auto status = ConnectTo(server.address()).Voxelize({}, kMesh, {}, options).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kCancelled);
  EXPECT_LT(absl::Now() - start, absl::Seconds(5));
  EXPECT_EQ(server.calls().size(), 1u);
  canceller.join();
}

TEST(Retry, AFullServerIsPassedOverForAnotherWithoutAWait) {
  ModelServer full(std::deque<Fault>(
      9, Fault{At::kStart, 0, ServerSays(grpc::StatusCode::UNAVAILABLE, "stopping", absl::Milliseconds(900))}));
  ModelServer other;
  const Client client = ConnectTo(full.address() + "," + other.address());
  const absl::Time start = absl::Now();
  for (int n = 0; n < 4; ++n) EXPECT_TRUE(client.Voxelize({}, kMesh, {}, Fast()).ok());
  EXPECT_LT(absl::Now() - start, absl::Milliseconds(800));
  EXPECT_EQ(other.calls().size(), 4u);
  EXPECT_GE(full.calls().size(), 1u);
}

TEST(Servers, CallsTakeTurns) {
  ModelServer one, other;
  const Client client = ConnectTo(one.address() + "," + other.address());
  EXPECT_TRUE(client.GetLimits().ok());
  // Connect waits for only one of them.
  for (int n = 0; n < 100 && other.calls().empty(); ++n) {
    EXPECT_TRUE(client.Voxelize({}, kMesh, {}).ok());
    absl::SleepFor(absl::Milliseconds(10));
  }
  const size_t calls = one.calls().size() + other.calls().size();
  const size_t before = one.calls().size();
  for (int n = 0; n < 10; ++n) EXPECT_TRUE(client.Voxelize({}, kMesh, {}).ok());
  EXPECT_EQ(one.calls().size() - before, 5u);
  EXPECT_EQ(one.calls().size() + other.calls().size(), calls + 10);
}

TEST(Servers, OneThatIsDownIsSkipped) {
  ModelServer up;
  for (const std::string& addresses : {"127.0.0.1:1," + up.address(), up.address() + ",127.0.0.1:1"}) {
    const Client client = ConnectTo(addresses);
    for (int n = 0; n < 5; ++n) EXPECT_TRUE(client.Voxelize({}, kMesh, {}, Fast(1)).ok());
  }
  const auto none = Client::Connect("127.0.0.1:1,127.0.0.1:2");
  EXPECT_EQ(none.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(none.status().message()), HasSubstr("127.0.0.1:1, 127.0.0.1:2"));
  for (const char* wrong : {"", ",", "127.0.0.1:1,"}) {
    EXPECT_EQ(Client::Connect(wrong).status().code(), absl::StatusCode::kInvalidArgument);
  }
  EXPECT_EQ(Client::Connect(std::vector<std::string>()).status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(Servers, OneThatComesBackIsFoundAgain) {
  auto server = std::make_unique<ModelServer>();
  const std::string address = server->address();
  const Client client = ConnectTo(address);
  ASSERT_TRUE(client.Voxelize({}, kMesh, {}, Fast()).ok());
  server.reset();
  std::thread starter([&] {
    absl::SleepFor(absl::Milliseconds(700));
    server = std::make_unique<ModelServer>(std::deque<Fault>(), 4, address);
  });
  const auto summary = client.Voxelize({}, kMesh, {});
  starter.join();
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_EQ(server->mesh_bytes_received(), kMesh.size()) << "asked first, then sent: the new server had not had it";
}

TEST(MeshIds, AreSha256) {
  const auto id = MeshIdOf("abc");
  ASSERT_TRUE(id.ok());
  EXPECT_EQ(absl::BytesToHexString(std::string(id->sha256.begin(), id->sha256.end())),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(id->bytes, 3u);
}

TEST(Meshes, ManyCallsWithOneMeshUploadItOnce) {
  ModelServer server;
  const Client client = ConnectTo(server.address());
  for (int n = 0; n < 5; ++n) ASSERT_TRUE(client.Voxelize({}, kMesh, {}, Fast()).ok());
  EXPECT_EQ(server.mesh_bytes_received(), kMesh.size());
  EXPECT_EQ(server.calls().size(), 5u);
  EXPECT_EQ(server.calls()[0].spec.mesh_sha256().size(), 32u);
  EXPECT_EQ(server.calls()[4].spec.mesh_bytes(), kMesh.size());
  server.DropMeshes();
  ASSERT_TRUE(client.Voxelize({}, kMesh, {}, Fast(0)).ok()) << "to send it after all is no retry";
  EXPECT_EQ(server.mesh_bytes_received(), 2 * kMesh.size());
  ASSERT_TRUE(client.Voxelize({}, kMesh + "x", {}, Fast()).ok());
  EXPECT_EQ(server.mesh_bytes_received(), 3 * kMesh.size() + 1);
}

TEST(Meshes, AStoredMeshIsVoxelizedWithoutItsBytes) {
  ModelServer server;
  const Client client = ConnectTo(server.address());
  const auto id = client.PutMesh(kMesh, Fast());
  ASSERT_TRUE(id.ok()) << id.status();
  EXPECT_EQ(*id, *MeshIdOf(kMesh));
  EXPECT_TRUE(client.Voxelize({}, *id, {}, Fast()).ok());
  EXPECT_TRUE(client.Voxelize({}, kMesh, {}, Fast()).ok());
  EXPECT_TRUE(client.PutMesh(kMesh, Fast()).ok());
  EXPECT_EQ(server.mesh_bytes_received(), kMesh.size());
  server.DropMeshes();
  const auto gone = client.Voxelize({}, *id, {}, Fast());
  EXPECT_EQ(gone.status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(GetErrorDetails(gone.status()).reason, "A_REASON");
  EXPECT_EQ(server.calls().size(), 3u) << "it is not asked twice";
}

TEST(Meshes, TheServerThatHasItIsAsked) {
  ModelServer one, other;
  const Client client = ConnectTo(one.address() + "," + other.address());
  const auto id = client.PutMesh(kMesh, Fast());
  ASSERT_TRUE(id.ok());
  for (int n = 0; n < 6; ++n) EXPECT_TRUE(client.Voxelize({}, *id, {}, Fast(1)).ok());
  EXPECT_EQ(one.calls().size() + other.calls().size(), 6u);
  // A client that does not know which server has the mesh asks all.
  const Client stranger = ConnectTo(one.address() + "," + other.address());
  for (int n = 0; n < 6; ++n) EXPECT_TRUE(stranger.Voxelize({}, *id, {}, Fast(1)).ok());
}

}  // namespace
}  // namespace latvox::client
