// The SDK's styles without handlers, BrickStream and VoxelizeAll, and the interface below them, VoxelService.
#include <gmock/gmock.h>

#include <atomic>
#include <iterator>
#include <thread>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "latvox/client.h"
#include "latvox/error.h"
#include "tests/unit/client/model_server.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using At = Fault::At;

static_assert(std::input_iterator<BrickStream::Iterator>);
static_assert(!std::is_copy_constructible_v<BrickStream> && !std::is_copy_constructible_v<Client>);

const std::string kMesh(3000000, 'm');

CallOptions Fast() {
  CallOptions options;
  options.retry = {5, absl::Milliseconds(1), absl::Milliseconds(20)};
  return options;
}

BrickStream StreamFrom(const ModelServer& server, const CallOptions& options = Fast()) {
  const absl::StatusOr<Client> client = Client::Connect(server.address());
  EXPECT_TRUE(client.ok()) << client.status();
  return client->Stream({}, kMesh, options);  // the stream outlives this client
}

// Appends the numbers of the batch's tiles. Tiles of the model server have one brick each.
void Append(const BrickBatch& batch, std::vector<int>& tiles) {
  for (const Brick& brick : batch.bricks) tiles.push_back(brick.brick_ijk[2] / 8);
}

// Takes batches until the end, or an error.
absl::Status Drain(BrickStream& stream, std::vector<int>& tiles) {
  for (;;) {
    const absl::StatusOr<std::optional<BrickBatch>> batch = stream.Next();
    if (!batch.ok()) return batch.status();
    if (!*batch) return absl::OkStatus();
    Append(**batch, tiles);
  }
}

TEST(BrickStream, GivesEveryBatchInOrderThenNothingThenTheSummary) {
  const ModelServer server({}, 9);
  BrickStream stream = StreamFrom(server);
  const absl::StatusOr<Accepted> accepted = stream.AwaitAccepted();
  ASSERT_TRUE(accepted.ok()) << accepted.status();
  EXPECT_EQ(accepted->index_box->max[2], 64 * 9);
  EXPECT_FALSE(stream.summary());
  std::vector<int> tiles;
  EXPECT_EQ(Drain(stream, tiles), absl::OkStatus());
  EXPECT_THAT(tiles, ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8));
  ASSERT_TRUE(stream.summary());
  EXPECT_EQ(stream.summary()->certificate.digest, ModelServer::DigestOfAll(9));
  EXPECT_EQ(Drain(stream, tiles), absl::OkStatus()) << "the end stays the end";
  EXPECT_EQ(tiles.size(), 9u);
}

TEST(BrickStream, IsARangeOfBatches) {
  const ModelServer server;
  BrickStream stream = StreamFrom(server);
  std::vector<int> tiles;
  double progress = 0;
  for (const absl::StatusOr<BrickBatch>& batch : stream) {
    ASSERT_TRUE(batch.ok()) << batch.status();
    EXPECT_GE(batch->progress, progress);
    progress = batch->progress;
    Append(*batch, tiles);
  }
  EXPECT_THAT(tiles, ElementsAre(0, 1, 2, 3));
  EXPECT_GT(progress, 0);
  EXPECT_TRUE(stream.summary());
}

TEST(BrickStream, AnErrorInTheMiddleComesAfterTheBatchesBeforeItAndStays) {
  const ModelServer server({{At::kBatch, 2, ServerSays(grpc::StatusCode::INTERNAL, "a defect")}});
  BrickStream stream = StreamFrom(server);
  std::vector<int> tiles;
  std::vector<absl::Status> errors;
  for (const absl::StatusOr<BrickBatch>& batch : stream) {
    if (batch.ok()) {
      Append(*batch, tiles);
    } else {
      errors.push_back(batch.status());
    }
  }
  EXPECT_THAT(tiles, ElementsAre(0, 1));
  ASSERT_EQ(errors.size(), 1u) << "a loop ends at an error";
  EXPECT_EQ(errors[0].message(), "a defect");
  EXPECT_EQ(stream.Next().status(), errors[0]);
  EXPECT_FALSE(stream.summary());
}

TEST(BrickStream, AStreamThatBreaksBelowItGoesOnUnnoticed) {
  const ModelServer server({{At::kBatch, 2, BrokenConnection()}, {At::kBatch, 1, BrokenConnection()}});
  BrickStream stream = StreamFrom(server);
  std::vector<int> tiles;
  EXPECT_EQ(Drain(stream, tiles), absl::OkStatus());
  EXPECT_THAT(tiles, ElementsAre(0, 1, 2, 3));
  ASSERT_TRUE(stream.summary());
  EXPECT_EQ(stream.summary()->resumed, 2);
  EXPECT_EQ(stream.summary()->certificate.digest, ModelServer::DigestOfAll());
}

// The fastest of several handles counts, because the machine is shared.
TEST(BrickStream, AHandleThatGoesCancelsWithin50Milliseconds) {
  const ModelServer server(std::deque<Fault>(5, Fault{At::kBatch, 2}));  // hangs after two batches
  absl::Duration fastest = absl::InfiniteDuration();
  for (int n = 0; n < 5; ++n) {
    std::optional<BrickStream> stream = StreamFrom(server);
    ASSERT_TRUE(stream->Next().ok());
    const absl::Time start = absl::Now();
    stream.reset();
    fastest = std::min(fastest, absl::Now() - start);
  }
  EXPECT_LT(fastest, absl::Milliseconds(50));
}

TEST(BrickStream, AssignmentToAHandleCancelsItsOldCall) {
  const ModelServer server({{At::kBatch, 1}});  // the first call hangs forever
  BrickStream stream = StreamFrom(server);
  ASSERT_TRUE(stream.Next().ok());
  stream = StreamFrom(server);
  BrickStream moved = std::move(stream);
  std::vector<int> tiles;
  EXPECT_EQ(Drain(moved, tiles), absl::OkStatus());
  EXPECT_THAT(tiles, ElementsAre(0, 1, 2, 3));
}

TEST(BrickStream, TheCallersCancellationEndsAWaitAndIsNotTouchedByTheStreams) {
  const ModelServer server(std::deque<Fault>(2, Fault{At::kBatch, 1}));
  const CallOptions options = Fast();
  { EXPECT_TRUE(StreamFrom(server, options).Next().ok()); }
  EXPECT_FALSE(options.cancellation.cancelled()) << "it may be that of other calls, too";
  BrickStream stream = StreamFrom(server, options);
  ASSERT_TRUE(stream.Next().ok());
  std::thread canceller([&] {
    absl::SleepFor(absl::Milliseconds(20));
    options.cancellation.Cancel();
  });
  EXPECT_EQ(stream.Next().status().code(), absl::StatusCode::kCancelled);
  canceller.join();
  BrickStream late = StreamFrom(server, options);
  EXPECT_EQ(late.AwaitAccepted().status().code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(late.Next().status().code(), absl::StatusCode::kCancelled);
}

TEST(BrickStream, TheDeadlineEndsAWait) {
  const ModelServer server({{At::kBatch, 1}});
  CallOptions options = Fast();
  options.deadline = absl::Now() + absl::Milliseconds(300);
  BrickStream stream = StreamFrom(server, options);
  std::vector<int> tiles;
  EXPECT_EQ(Drain(stream, tiles).code(), absl::StatusCode::kDeadlineExceeded);
}

// Offers many batches, and counts them.
class Offering final : public VoxelService {
 public:
  static constexpr int kBatches = 100;

  absl::StatusOr<Summary> Voxelize(const VoxelizeRequest&, const MeshInput&, const VoxelizeHandlers& handlers,
                                   const CallOptions&) override {
    const Brick brick{{0, 0, 0}, {1}};
    for (; begun < kBatches; ++begun) {
      if (absl::Status status = handlers.on_bricks({{&brick, 1}, 0.5}); !status.ok()) return status;
    }
    return Summary{};
  }

  std::atomic<int> begun = 0;  // batches taken from it
};

TEST(BrickStream, ASlowConsumerHoldsFourBatchesAndTheServerBack) {
  const auto service = std::make_shared<Offering>();
  BrickStream stream = Client(service).Stream({}, kMesh);
  for (int taken = 1; taken <= Offering::kBatches; ++taken) {
    const absl::StatusOr<std::optional<BrickBatch>> batch = stream.Next();
    ASSERT_TRUE(batch.ok() && *batch);
    // It reads three batches ahead, and no more.
    const int ahead = std::min(taken + 3, Offering::kBatches);
    for (const absl::Time end = absl::Now() + absl::Seconds(10); service->begun < ahead && absl::Now() < end;) {
      absl::SleepFor(absl::Microseconds(100));
    }
    EXPECT_EQ(service->begun, ahead);
  }
  EXPECT_EQ(stream.Next().value(), std::nullopt);
}

TEST(BrickStream, AServiceThatNeverAcceptsIsAnError) {
  BrickStream stream = Client(std::make_shared<Offering>()).Stream({}, MeshId());
  std::vector<int> tiles;
  ASSERT_EQ(Drain(stream, tiles), absl::OkStatus());
  EXPECT_EQ(stream.AwaitAccepted().status().code(), absl::StatusCode::kInternal);
}

TEST(VoxelizeAll, ReturnsAllThatHandlersReceive) {
  const ModelServer server({{At::kBatch, 2, BrokenConnection()}});
  const absl::StatusOr<Client> client = Client::Connect(server.address());
  ASSERT_TRUE(client.ok());
  const absl::StatusOr<Voxelization> all = client->VoxelizeAll({}, kMesh, Fast());
  ASSERT_TRUE(all.ok()) << all.status();
  EXPECT_EQ(all->accepted.index_box->max[2], 64 * 4);
  std::vector<int> tiles;
  Append({all->bricks}, tiles);
  EXPECT_THAT(tiles, ElementsAre(0, 1, 2, 3));
  EXPECT_EQ(all->summary.certificate.digest, ModelServer::DigestOfAll());
  EXPECT_EQ(client->VoxelizeAll({}, MeshId()).status().code(), absl::StatusCode::kNotFound);
}

TEST(VoxelService, AMethodThatAStandInLacksIsUnimplementedAndNamed) {
  const Client client(std::make_shared<VoxelService>());
  const CallOptions options;
  const std::pair<const char*, absl::Status> ends[] = {
      {"Voxelize", client.Voxelize({}, kMesh, {}).status()},
      {"Voxelize", client.VoxelizeAll({}, kMesh).status()},
      {"Voxelize", client.Stream({}, kMesh).Next().status()},
      {"PutMesh", client.PutMesh(kMesh).status()},
      {"Pixelize", client.Pixelize({}).status()},
      {"GetLimits", client.GetLimits().status()},
      {"Health", client.Health().status()},
  };
  for (const auto& [method, status] : ends) {
    EXPECT_EQ(status.code(), absl::StatusCode::kUnimplemented);
    EXPECT_THAT(std::string(status.message()), HasSubstr(method));
  }
}

// Returns the arguments of its calls, as errors.
class Recording final : public VoxelService {
 public:
  absl::Status PutMesh(const MeshId& mesh, std::string_view mesh_bytes, const CallOptions&) override {
    return absl::DataLossError(absl::StrCat(mesh.bytes, " of ", mesh_bytes.size()));
  }
  absl::StatusOr<Summary> Voxelize(const VoxelizeRequest& request, const MeshInput& mesh, const VoxelizeHandlers&,
                                   const CallOptions& options) override {
    return absl::DataLossError(
        absl::StrCat(*request.resolution, " ", mesh.id.bytes, " ", mesh.drc.has_value(), " ", options.traceparent));
  }
};

TEST(VoxelService, SeesRequestMeshAndOptions) {
  const Client client(std::make_shared<Recording>());
  VoxelizeRequest request;
  request.resolution = 7;
  CallOptions options;
  options.traceparent = "t";
  MeshId id;
  id.bytes = 5;
  EXPECT_EQ(client.PutMesh("mesh").status(), absl::DataLossError("4 of 4"));
  EXPECT_EQ(client.Voxelize(request, "mesh", {}, options).status(), absl::DataLossError("7 4 1 t"));
  EXPECT_EQ(client.Stream(request, "mesh", options).Next().status(), absl::DataLossError("7 4 1 t"));
  EXPECT_EQ(client.Stream(request, id, options).Next().status(), absl::DataLossError("7 5 0 t"));
  EXPECT_EQ(client.VoxelizeAll(request, id, options).status(), absl::DataLossError("7 5 0 t"));
}

TEST(VoxelService, SeesNoEmptyMeshAndNoRequestWithTwoSamplings) {
  const Client client(std::make_shared<Recording>());
  VoxelizeRequest request;
  request.resolution = 7;
  request.voxel_size = 0.5;
  PixelizeRequest plane;
  plane.resolution = 7;
  plane.pixel_size = 0.5;
  const std::vector<std::tuple<const char*, const char*, absl::Status>> refusals = {
      {"mesh_bytes", "mesh_bytes: has 0 bytes", client.Voxelize({}, "", {}).status()},
      {"mesh_bytes", "mesh_bytes: has 0 bytes", client.VoxelizeAll({}, "").status()},
      {"mesh_bytes", "mesh_bytes: has 0 bytes", client.Stream({}, std::string()).Next().status()},
      {"mesh_bytes", "mesh_bytes: has 0 bytes", client.PutMesh("").status()},
      {"resolution", "resolution: 7 not together with voxel_size 0.5", client.Voxelize(request, "mesh", {}).status()},
      {"resolution", "resolution: 7 not together with voxel_size 0.5",
       client.Stream(request, MeshId()).Next().status()},
      {"resolution", "resolution: 7 not together with pixel_size 0.5", client.Pixelize(plane).status()}};
  for (const auto& [field, message, status] : refusals) {
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr(message));
    EXPECT_EQ(GetErrorDetails(status).field, field);
  }
}

}  // namespace
}  // namespace latvox::client
