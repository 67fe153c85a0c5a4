// A server with the answers of a test, and a set of answers that keep the protocol.
#ifndef LATVOX_TESTS_UNIT_CLIENT_FAKE_SERVER_H_
#define LATVOX_TESTS_UNIT_CLIENT_FAKE_SERVER_H_

#include <grpcpp/ext/health_check_service_server_builder_option.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/internal/digest.h"
#include "latvox/client.h"
#include "latvox/v1/voxelizer.grpc.pb.h"

namespace latvox::client {

using Stream = grpc::ServerReaderWriter<v1::VoxelizeResponse, v1::VoxelizeRequest>;
using Behavior = std::function<grpc::Status(grpc::ServerContext*, Stream*)>;

class FakeService final : public v1::Voxelizer::Service {
 public:
  explicit FakeService(Behavior behavior) : behavior_(std::move(behavior)) {}
  grpc::Status Voxelize(grpc::ServerContext* context, Stream* stream) override { return behavior_(context, stream); }
  grpc::Status GetLimits(grpc::ServerContext*, const v1::GetLimitsRequest*, v1::GetLimitsResponse* response) override {
    response->set_max_extent(65536);
    response->set_version("fake");
    response->set_commit("abc");
    v1::Library& library = *response->add_libraries();
    library.set_name("gRPC");
    library.set_version("1.51.1");
    return grpc::Status::OK;
  }

 private:
  Behavior behavior_;
};

// A server in this process, with a client connected to it.
class Fake {
 public:
  explicit Fake(Behavior behavior) : service_(std::move(behavior)) {
    grpc::EnableDefaultHealthCheckService(true);
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
    builder.RegisterService(&service_);
    builder.SetMaxReceiveMessageSize(2 << 20);
    server_ = builder.BuildAndStart();
    auto client = Client::Connect(address());
    EXPECT_TRUE(client.ok()) << client.status();
    client_.emplace(*std::move(client));
  }
  ~Fake() { server_->Shutdown(std::chrono::system_clock::now()); }

  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  const Client& client() const { return *client_; }
  grpc::Server& server() { return *server_; }

 private:
  FakeService service_;
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
  std::optional<Client> client_;
};

// Answers that keep the protocol: three bricks in two tiles. Tests break one thing at a time.
struct Answers {
  v1::VoxelizeResponse accepted, first, second, summary;

  explicit Answers(uint64_t mesh_bytes) {
    v1::Grid& grid = *accepted.mutable_accepted()->mutable_grid();
    grid.mutable_basis()->mutable_a()->set_x(1);
    grid.mutable_basis()->mutable_b()->set_y(1);
    grid.mutable_basis()->mutable_c()->set_z(1);
    grid.mutable_origin();
    grid.set_voxel_size(1);
    accepted.mutable_accepted()->mutable_index_box()->mutable_min()->set_i(-8);
    auto* max = accepted.mutable_accepted()->mutable_index_box()->mutable_max();
    max->set_i(64);
    max->set_j(64);
    max->set_k(64);
    Digest digest;
    Append({-1, 0, 0}, 1, *first.mutable_bricks(), digest);
    Append({0, 0, 0}, 0xF0, *second.mutable_bricks(), digest);
    Append({0, 7, 1}, 2, *second.mutable_bricks(), digest);
    first.mutable_bricks()->set_progress(0.5);
    second.mutable_bricks()->set_progress(1);
    v1::Summary& end = *summary.mutable_summary();
    end.set_voxels(6);
    end.set_bricks(3);
    end.set_tiles(2);
    end.set_mesh_bytes(mesh_bytes);
    end.mutable_certificate()->set_set("surface");
    end.mutable_certificate()->set_digest(digest.ToHex());
  }

  static void Append(const Vec3i& brick_ijk, uint64_t first_word, v1::BrickBatch& batch, Digest& digest) {
    Brick brick{brick_ijk, {first_word}};
    digest.Add(brick);
    for (const int32_t index : brick_ijk) batch.add_brick_ijk(index);
    batch.mutable_masks()->append(reinterpret_cast<const char*>(brick.mask.data()), sizeof(brick.mask));
  }

  std::vector<v1::VoxelizeResponse> All() const { return {accepted, first, second, summary}; }
};

inline const std::string kMesh(3000000, 'm');

// Reads everything, then sends these answers.
inline Behavior Send(const std::vector<v1::VoxelizeResponse>& answers) {
  return [answers](grpc::ServerContext*, Stream* stream) {
    for (v1::VoxelizeRequest request; stream->Read(&request);) continue;
    for (const auto& answer : answers) stream->Write(answer);
    return grpc::Status::OK;
  };
}

inline absl::Status CallWith(const std::vector<v1::VoxelizeResponse>& answers) {
  return Fake(Send(answers)).client().Voxelize({}, kMesh, {}).status();
}

}  // namespace latvox::client

#endif  // LATVOX_TESTS_UNIT_CLIENT_FAKE_SERVER_H_
