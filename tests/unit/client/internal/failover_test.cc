// The SDK and real servers that die: SIGKILL, SIGTERM, and another server in their place.
#include <gmock/gmock.h>

#include <csignal>
#include <memory>

#include "absl/time/clock.h"
#include "latvox/client.h"
#include "tests/unit/server/meshes.h"
#include "tests/unit/server/process.h"
#include "tests/unit/temporary_directory.h"

namespace latvox::client {
namespace {

// A server on its own socket. A restart keeps the address.
class Server {
 public:
  explicit Server(std::vector<std::string> options = {}) : options_(std::move(options)) { Start(); }

  void Start() {
    // A killed server leaves its socket behind.
    unlink(path_.c_str());
    std::vector<std::string> arguments = {"--listen", address()};
    arguments.insert(arguments.end(), options_.begin(), options_.end());
    process_ = std::make_unique<Process>(Latvoxd(arguments));
    process_->ReadUntil("event=listening");
  }
  void Signal(int signal) const { kill(process_->pid(), signal); }
  int Wait() { return process_->Wait(); }
  std::string address() const { return "unix:" + path_; }

 private:
  const TemporaryDirectory directory_;
  const std::string path_ = directory_ / "socket";
  const std::vector<std::string> options_;
  std::unique_ptr<Process> process_;
};

// The result is far larger than the buffers of gRPC and sockets. So a server that dies midway has not sent all of it.
VoxelizeRequest Large() {
  VoxelizeRequest request;
  request.lattice = NamedLattice::kBcc;
  request.resolution = 3000;
  return request;
}

const std::string& Mesh() {
  static const std::string mesh = EncodeDraco(Sphere(60), {});
  return mesh;
}

Client ConnectTo(const std::string& addresses) {
  absl::StatusOr<Client> client = Client::Connect(addresses);
  EXPECT_TRUE(client.ok()) << client.status();
  return *std::move(client);
}

// Returns handlers that call `act` once, after `bricks` bricks.
VoxelizeHandlers After(uint64_t bricks, std::function<void()> act) {
  VoxelizeHandlers handlers;
  auto left = std::make_shared<int64_t>(static_cast<int64_t>(bricks));
  handlers.on_bricks = [left, act = std::move(act)](const BrickBatch& batch) {
    const bool before = *left > 0;
    *left -= static_cast<int64_t>(batch.bricks.size());
    if (before && *left <= 0) act();
    return absl::OkStatus();
  };
  return handlers;
}

const Summary& Undisturbed() {
  static const Summary summary = *ConnectTo(Server().address()).Voxelize(Large(), Mesh(), {});
  return summary;
}

void ExpectLikeUndisturbed(const absl::StatusOr<Summary>& summary, int resumed) {
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_EQ(summary->certificate.digest, Undisturbed().certificate.digest);
  EXPECT_EQ(summary->voxels, Undisturbed().voxels);
  EXPECT_EQ(summary->bricks, Undisturbed().bricks);
  EXPECT_EQ(summary->tiles, Undisturbed().tiles);
  EXPECT_EQ(summary->resumed, resumed);
}

TEST(Failover, AnotherServerGoesOnWhereTheKilledOneWas) {
  Server first, second;
  second.Signal(SIGKILL);
  second.Wait();
  const Client client = ConnectTo(first.address() + "," + second.address());
  uint64_t before = 0, after = 0;
  bool killed = false;
  VoxelizeHandlers handlers = After(Undisturbed().bricks / 2, [&] {
    second.Start();
    first.Signal(SIGKILL);
    killed = true;
  });
  handlers.on_bricks = [&, take = handlers.on_bricks](const BrickBatch& batch) {
    (killed ? after : before) += batch.bricks.size();
    return take(batch);
  };
  std::optional<Resumption> resumption;
  handlers.on_resumed = [&](const Resumption& r) { return resumption = r, absl::OkStatus(); };
  const auto summary = client.Voxelize(Large(), Mesh(), handlers);
  ExpectLikeUndisturbed(summary, 1);
  ASSERT_TRUE(resumption);
  EXPECT_EQ(resumption->address, second.address());
  EXPECT_TRUE(resumption->after_tile);
  EXPECT_EQ(before + after, summary->bricks) << "no brick came twice";
  EXPECT_GT(summary->bytes_sent, 2 * Mesh().size()) << "the second server did not have the mesh";
  EXPECT_LT(summary->bytes_received, Undisturbed().bytes_received + (16 << 20)) << "what was there is not sent again";
}

TEST(Failover, AServerThatIsStartedAgainGoesOn) {
  Server server;
  const auto summary = ConnectTo(server.address()).Voxelize(Large(), Mesh(), After(Undisturbed().bricks / 3, [&] {
                                                              server.Signal(SIGKILL);
                                                              server.Wait();
                                                              server.Start();
                                                            }));
  ExpectLikeUndisturbed(summary, 1);
}

TEST(Failover, ACallSurvivesAServerThatIsKilledAgainAndAgain) {
  Server one, other;
  Server* const both[] = {&one, &other};
  const Client client = ConnectTo(one.address() + "," + other.address());
  uint64_t bricks = 0, next = Undisturbed().bricks / 8;
  int kills = 0;
  VoxelizeHandlers handlers;
  handlers.on_bricks = [&](const BrickBatch& batch) {
    bricks += batch.bricks.size();
    if (bricks < next) return absl::OkStatus();
    next += Undisturbed().bricks / 8;
    ++kills;
    for (Server* server : both) {
      server->Signal(SIGKILL);
      server->Wait();
      server->Start();
    }
    return absl::OkStatus();
  };
  const auto summary = client.Voxelize(Large(), Mesh(), handlers);
  ASSERT_TRUE(summary.ok()) << summary.status();
  EXPECT_GE(kills, 7);
  EXPECT_GE(summary->resumed, 5) << "kills that came when all had been sent already are not noticed";
  ExpectLikeUndisturbed(summary, summary->resumed);
}

TEST(Failover, AServerThatDrainsTellsItsCallsToGoOnElsewhere) {
  Server first({"--grace", "0"}), second;
  second.Signal(SIGKILL);
  second.Wait();
  const Client client = ConnectTo(first.address() + "," + second.address());
  VoxelizeHandlers handlers = After(Undisturbed().bricks / 2, [&] {
    second.Start();
    first.Signal(SIGTERM);
  });
  std::optional<Resumption> resumption;
  handlers.on_resumed = [&](const Resumption& r) { return resumption = r, absl::OkStatus(); };
  ExpectLikeUndisturbed(client.Voxelize(Large(), Mesh(), handlers), 1);
  ASSERT_TRUE(resumption);
  EXPECT_EQ(resumption->address, second.address());
  EXPECT_EQ(first.Wait(), 0);
}

// This needs a real server: a model server in the same process would poll the client's connection, too.
TEST(Failover, AHandlerThatTakesItsTimeIsNotTakenForADeadServer) {
  Server server;
  ConnectionOptions options;
  options.keepalive_time = absl::Seconds(1);
  options.keepalive_timeout = absl::Seconds(2);
  const absl::StatusOr<Client> client = Client::Connect(server.address(), {}, options);
  ASSERT_TRUE(client.ok()) << client.status();
  ExpectLikeUndisturbed(client->Voxelize(Large(), Mesh(), After(1, [] { absl::SleepFor(absl::Seconds(4)); })), 0);
}

TEST(Failover, ManyCallsWithOneMeshUploadItOnce) {
  Server server;
  const Client client = ConnectTo(server.address());
  VoxelizeRequest small;
  small.resolution = 20;
  const auto first = client.Voxelize(small, Mesh(), {});
  ASSERT_TRUE(first.ok()) << first.status();
  EXPECT_GT(first->bytes_sent, Mesh().size());
  for (int n = 0; n < 3; ++n) {
    const auto again = client.Voxelize(small, Mesh(), {});
    ASSERT_TRUE(again.ok()) << again.status();
    EXPECT_LT(again->bytes_sent, 200u);
    EXPECT_EQ(again->certificate.digest, first->certificate.digest);
    EXPECT_EQ(again->mesh_bytes, Mesh().size());
  }
  // Other clients find the mesh, too. After a restart it is gone.
  const auto id = MeshIdOf(Mesh());
  EXPECT_TRUE(ConnectTo(server.address()).Voxelize(small, *id, {}).ok());
  EXPECT_TRUE(client.PutMesh(Mesh()).ok());
  server.Signal(SIGKILL);
  server.Wait();
  server.Start();
  EXPECT_EQ(client.Voxelize(small, *id, {}).status().code(), absl::StatusCode::kNotFound);
  EXPECT_TRUE(client.Voxelize(small, Mesh(), {}).ok());
  EXPECT_EQ(*client.PutMesh(Mesh()), *id);
  EXPECT_TRUE(client.Voxelize(small, *id, {}).ok());
}

}  // namespace
}  // namespace latvox::client
