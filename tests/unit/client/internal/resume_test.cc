// Streams that break: the SDK joins them, so the caller sees one whole stream.
#include <gmock/gmock.h>

#include <set>
#include <thread>

#include "absl/time/clock.h"
#include "latvox/client.h"
#include "latvox/error.h"
#include "tests/unit/client/model_server.h"
#include "tests/unit/client/relay.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using At = Fault::At;

const std::string kMesh(3000000, 'm');

CallOptions Fast(int retries = 5) {
  CallOptions options;
  options.retry = {retries, absl::Milliseconds(1), absl::Milliseconds(20)};
  return options;
}

// Records the calls of one call's handlers.
struct Seen {
  int accepted = 0;
  std::vector<int> tiles;
  std::vector<double> progress;
  std::vector<Resumption> resumptions;

  VoxelizeHandlers Handlers() {
    VoxelizeHandlers handlers;
    handlers.on_accepted = [this](const Accepted&) { return ++accepted, absl::OkStatus(); };
    handlers.on_bricks = [this](const BrickBatch& batch) {
      for (const Brick& brick : batch.bricks) tiles.push_back(brick.brick_ijk[2] / 8);
      progress.push_back(batch.progress);
      return absl::OkStatus();
    };
    handlers.on_resumed = [this](const Resumption& r) { return resumptions.push_back(r), absl::OkStatus(); };
    return handlers;
  }
};

Client ConnectTo(const std::string& addresses, const ConnectionOptions& options = {}) {
  absl::StatusOr<Client> client = Client::Connect(addresses, {}, options);
  EXPECT_TRUE(client.ok()) << client.status();
  return *std::move(client);
}

void ExpectWhole(const absl::StatusOr<Summary>& summary, const Seen& seen) {
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_EQ(seen.accepted, 1);
  EXPECT_THAT(seen.tiles, ElementsAre(0, 1, 2, 3));
  EXPECT_TRUE(std::is_sorted(seen.progress.begin(), seen.progress.end()));
  EXPECT_EQ(summary->voxels, 10u);
  EXPECT_EQ(summary->bricks, 4u);
  EXPECT_EQ(summary->tiles, 4u);
  EXPECT_EQ(summary->mesh_bytes, kMesh.size());
  EXPECT_EQ(summary->certificate.digest, ModelServer::DigestOfAll());
}

TEST(Resume, AStreamThatBreaksAnywhereEndsWhole) {
  struct Case {
    const char* name;
    Fault fault;
    int resumed;
  };
  const grpc::Status broken = BrokenConnection();
  for (const Case& c : {
           Case{"at the start", {At::kStart, 0, broken}, 0},
           Case{"during the upload", {At::kUpload, 0, broken}, 0},
           Case{"before Accepted", {At::kAccepted, 0, broken}, 0},
           Case{"after Accepted", {At::kBatch, 0, broken}, 1},
           Case{"after a batch", {At::kBatch, 1, broken}, 1},
           Case{"before the last batch", {At::kBatch, 3, broken}, 1},
           Case{"after the last batch", {At::kSummary, 0, broken}, 1},
           Case{"after the summary", {At::kEnd, 0, broken}, 0},
           Case{"reset", {At::kBatch, 2, {grpc::StatusCode::INTERNAL, "RST_STREAM with error code 2"}}, 1},
           Case{"removed", {At::kBatch, 2, {grpc::StatusCode::UNKNOWN, "Stream removed"}}, 1},
           Case{"cancelled by a proxy", {At::kBatch, 2, {grpc::StatusCode::CANCELLED, "RST_STREAM"}}, 1},
           Case{"short of memory", {At::kBatch, 2, {grpc::StatusCode::RESOURCE_EXHAUSTED, "RST_STREAM 11"}}, 1},
           Case{"drained",
                {At::kBatch, 2, ServerSays(grpc::StatusCode::UNAVAILABLE, "stopping", absl::Milliseconds(5))},
                1},
       }) {
    SCOPED_TRACE(c.name);
    ModelServer server({c.fault});
    Seen seen;
    const auto summary = ConnectTo(server.address()).Voxelize({}, kMesh, seen.Handlers(), Fast());
    ExpectWhole(summary, seen);
    EXPECT_EQ(summary.ok() ? summary->resumed : -1, c.resumed);
    EXPECT_EQ(seen.resumptions.size(), size_t(c.resumed));
  }
}

TEST(Resume, GoesOnAfterTheLastTileThatWasPassedOn) {
  ModelServer server(
      {{At::kBatch, 2, BrokenConnection()}, {At::kBatch, 0, BrokenConnection()}, {At::kBatch, 1, BrokenConnection()}});
  Seen seen;
  ExpectWhole(ConnectTo(server.address()).Voxelize({}, kMesh, seen.Handlers(), Fast()), seen);
  const auto calls = server.calls();
  ASSERT_EQ(calls.size(), 4u);
  EXPECT_FALSE(calls[0].spec.has_resume_after());
  EXPECT_EQ(calls[1].spec.resume_after().k(), 1);
  EXPECT_EQ(calls[2].spec.resume_after().k(), 1);
  EXPECT_EQ(calls[3].spec.resume_after().k(), 2);
  ASSERT_EQ(seen.resumptions.size(), 3u);
  EXPECT_EQ(seen.resumptions[2].after_tile, (Vec3i{0, 0, 2}));
  EXPECT_EQ(seen.resumptions[2].address, server.address());
  EXPECT_EQ(seen.resumptions[2].cause.code(), absl::StatusCode::kUnavailable);
}

TEST(Resume, TheMeshIsSentAgainOnlyIfTheServerDoesNotHaveIt) {
  ModelServer server({{At::kBatch, 1, BrokenConnection()}});
  Seen seen;
  const auto summary = ConnectTo(server.address()).Voxelize({}, kMesh, seen.Handlers(), Fast());
  ExpectWhole(summary, seen);
  EXPECT_EQ(server.mesh_bytes_received(), kMesh.size());
  EXPECT_LT(summary->bytes_sent, kMesh.size() + 2000);

  ModelServer forgetful({{At::kBatch, 1, BrokenConnection()}});
  Seen again;
  VoxelizeHandlers handlers = again.Handlers();
  handlers.on_bricks = [&, take = handlers.on_bricks](const BrickBatch& batch) {
    if (again.tiles.empty()) forgetful.DropMeshes();
    return take(batch);
  };
  const auto sent_twice = ConnectTo(forgetful.address()).Voxelize({}, kMesh, handlers, Fast());
  ExpectWhole(sent_twice, again);
  EXPECT_EQ(forgetful.calls().size(), 3u) << "broken, asked for the mesh, sent it";
  EXPECT_EQ(forgetful.mesh_bytes_received(), 2 * kMesh.size());
  EXPECT_GT(sent_twice->bytes_sent, 2 * kMesh.size());
  EXPECT_EQ(sent_twice->resumed, 1);
}

TEST(Resume, AnotherServerGoesOn) {
  ModelServer first({{At::kBatch, 2}, {At::kBatch, 2}, {At::kBatch, 2}}), second;  // the first one hangs
  const Client client = ConnectTo(first.address() + "," + second.address());
  Seen seen;
  // Calls take turns: repeats until the first server has had one.
  for (int n = 0; n < 3 && seen.resumptions.empty(); ++n) {
    seen = {};
    VoxelizeHandlers handlers = seen.Handlers();
    handlers.on_bricks = [&, take = handlers.on_bricks](const BrickBatch& batch) {
      const absl::Status status = take(batch);
      if (seen.tiles.size() == 2 && !first.calls().empty()) first.Stop();
      return status;
    };
    ExpectWhole(client.Voxelize({}, kMesh, handlers, Fast()), seen);
  }
  ASSERT_EQ(seen.resumptions.size(), 1u);
  EXPECT_EQ(seen.resumptions[0].address, second.address());
  EXPECT_EQ(seen.resumptions[0].after_tile, (Vec3i{0, 0, 1}));
}

TEST(Resume, AnAnswerThatDiffersIsDataLossThatNamesIt) {
  struct Case {
    const char* says;
    std::function<void(v1::Accepted&)> change;
  };
  for (const Case& c : {
           Case{"grid", [](v1::Accepted& a) { a.mutable_grid()->mutable_origin()->set_x(1); }},
           Case{"index_box", [](v1::Accepted& a) { a.mutable_index_box()->mutable_max()->set_i(65); }},
           Case{"index_box", [](v1::Accepted& a) { a.clear_index_box(); }},
           Case{"mesh", [](v1::Accepted& a) { a.mutable_mesh()->set_triangles(13); }},
       }) {
    SCOPED_TRACE(c.says);
    Fault changed;
    changed.change = [&](v1::VoxelizeResponse& response) {
      if (response.has_accepted()) c.change(*response.mutable_accepted());
    };
    ModelServer server({{At::kBatch, 2, BrokenConnection()}, changed});
    Seen seen;
    const auto status = ConnectTo(server.address()).Voxelize({}, kMesh, seen.Handlers(), Fast()).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(std::string("Accepted.") + c.says));
    EXPECT_EQ(server.calls().size(), 2u) << "it is of no use to go on";
  }
}

TEST(Resume, AnswersThatDifferOnlyInTheRequestIdAreTheSame) {
  const auto name = [](const char* id) {
    return [id](v1::VoxelizeResponse& response) {
      if (response.has_accepted()) response.mutable_accepted()->set_request_id(id);
    };
  };
  ModelServer server({{At::kBatch, 2, BrokenConnection(), "", name("a")}, {At::kNever, 0, {}, "", name("b")}});
  Seen seen;
  ExpectWhole(ConnectTo(server.address()).Voxelize({}, kMesh, seen.Handlers(), Fast()), seen);
}

TEST(Resume, ATileThatCameBeforeIsDataLoss) {
  Fault repeats;
  repeats.change = [](v1::VoxelizeResponse& response) {
    if (response.has_bricks()) response.mutable_bricks()->set_brick_ijk(2, 8);  // tile 1
  };
  ModelServer server({{At::kBatch, 2, BrokenConnection()}, repeats});
  Seen seen;
  const auto status = ConnectTo(server.address()).Voxelize({}, kMesh, seen.Handlers(), Fast()).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(status.message()), HasSubstr("tile 0,0,1 came twice"));
  EXPECT_THAT(seen.tiles, ElementsAre(0, 1)) << "a handler never sees a tile twice";
}

TEST(Resume, TheSummaryMustMatchItsOwnStream) {
  Fault wrong;
  wrong.change = [](v1::VoxelizeResponse& response) {
    if (response.has_summary()) response.mutable_summary()->set_voxels(10);  // the count of the whole
  };
  ModelServer server({{At::kBatch, 2, BrokenConnection()}, wrong});
  const auto status = ConnectTo(server.address()).Voxelize({}, kMesh, {}, Fast()).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss);
  EXPECT_THAT(std::string(status.message()), HasSubstr("10 voxels after 7"));
}

TEST(Resume, AnAnswerOfTheServerItselfIsFinal) {
  for (const grpc::StatusCode code : {grpc::StatusCode::INVALID_ARGUMENT, grpc::StatusCode::INTERNAL,
                                      grpc::StatusCode::RESOURCE_EXHAUSTED, grpc::StatusCode::UNAUTHENTICATED}) {
    ModelServer server({{At::kBatch, 1, ServerSays(code, "no")}});
    const auto status = ConnectTo(server.address()).Voxelize({}, kMesh, {}, Fast()).status();
    EXPECT_EQ(static_cast<int>(status.code()), static_cast<int>(code));
    EXPECT_EQ(status.message(), "no");
    EXPECT_EQ(GetErrorDetails(status).reason, "A_REASON");
    EXPECT_EQ(server.calls().size(), 1u);
  }
}

TEST(Resume, AnErrorOfAHandlerEndsItAtOnce) {
  ModelServer server({{At::kBatch, 1, BrokenConnection()}, {At::kBatch, 1}});
  Seen seen;
  VoxelizeHandlers handlers = seen.Handlers();
  handlers.on_resumed = [](const Resumption&) { return absl::DataLossError("the log is full"); };
  const auto status = ConnectTo(server.address()).Voxelize({}, kMesh, handlers, Fast()).status();
  EXPECT_EQ(status, absl::DataLossError("the log is full"));
  EXPECT_THAT(seen.tiles, ElementsAre(0));
}

TEST(Resume, ProgressStartsTheCountOfTriesAnew) {
  // One tile for each stream; one try without progress is allowed.
  ModelServer server(std::deque<Fault>(8, Fault{At::kBatch, 1, BrokenConnection()}), 9);
  const auto summary = ConnectTo(server.address()).Voxelize({}, kMesh, {}, Fast(1));
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_EQ(summary->certificate.digest, ModelServer::DigestOfAll(9));
  EXPECT_EQ(summary->resumed, 8);
}

TEST(Resume, WithoutProgressItGivesUp) {
  for (const int retries : {0, 3}) {
    ModelServer server(std::deque<Fault>(20, Fault{At::kBatch, 0, BrokenConnection()}));
    const auto status = ConnectTo(server.address()).Voxelize({}, kMesh, {}, Fast(retries)).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
    // Accepted counts as progress only once.
    EXPECT_EQ(server.calls().size(), size_t(retries) + 1);
  }
}

TEST(Resume, AConnectionThatIsResetGoesOn) {
  ModelServer server({{At::kBatch, 2}});
  Relay relay(server.address());
  Seen seen;
  VoxelizeHandlers handlers = seen.Handlers();
  handlers.on_bricks = [&, take = handlers.on_bricks](const BrickBatch& batch) {
    const absl::Status status = take(batch);
    if (seen.tiles.size() == 2) relay.Cut();
    return status;
  };
  ExpectWhole(ConnectTo(relay.address()).Voxelize({}, kMesh, handlers, Fast()), seen);
  EXPECT_EQ(seen.resumptions.size(), 1u);
}

TEST(Resume, AConnectionThatFallsSilentIsNoticedAndGoesOn) {
  ModelServer server({{At::kBatch, 2}});
  Relay relay(server.address());
  Seen seen;
  VoxelizeHandlers handlers = seen.Handlers();
  handlers.on_bricks = [&, take = handlers.on_bricks](const BrickBatch& batch) {
    const absl::Status status = take(batch);
    if (seen.tiles.size() == 2) relay.Freeze();
    return status;
  };
  ConnectionOptions options;
  options.keepalive_time = absl::Seconds(1);
  options.keepalive_timeout = absl::Seconds(1);
  const absl::Time start = absl::Now();
  ExpectWhole(ConnectTo(relay.address(), options).Voxelize({}, kMesh, handlers, Fast()), seen);
  EXPECT_EQ(seen.resumptions.size(), 1u);
  EXPECT_LT(absl::Now() - start, absl::Seconds(8));
}

}  // namespace
}  // namespace latvox::client
