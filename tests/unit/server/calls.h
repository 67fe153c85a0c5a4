// Whole calls through a real channel, for the server's tests.
#ifndef LATVOX_TESTS_UNIT_SERVER_CALLS_H_
#define LATVOX_TESTS_UNIT_SERVER_CALLS_H_

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "core/brick/brick.h"
#include "latvox/v1/voxelizer.grpc.pb.h"
#include "server/decode/mesh_store.h"
#include "server/listen/server.h"
#include "tests/unit/server/decoders.h"
#include "tests/unit/server/meshes.h"
#include "tests/unit/temporary_directory.h"

namespace latvox {

using Stream = grpc::ClientReaderWriter<v1::VoxelizeRequest, v1::VoxelizeResponse>;

inline constexpr auto kPatience = std::chrono::seconds(100);  // only a failing test waits so long

inline bool Eventually(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

inline v1::VoxelizeSpec Spec(uint32_t resolution, v1::NamedLattice lattice = v1::NAMED_LATTICE_BCC) {
  v1::VoxelizeSpec spec;
  spec.mutable_lattice()->set_named(lattice);
  spec.set_resolution(resolution);
  return spec;
}

inline v1::VoxelizeRequest SpecMessage(const v1::VoxelizeSpec& spec) {
  v1::VoxelizeRequest request;
  *request.mutable_spec() = spec;
  return request;
}

inline v1::VoxelizeRequest PieceMessage(std::string piece) {
  v1::VoxelizeRequest request;
  request.set_mesh_piece(std::move(piece));
  return request;
}

inline const std::string& SphereBytes() {
  static const auto& bytes = *new std::string(EncodeDraco(Sphere(40), {}));
  return bytes;
}

// Everything that came back.
struct Answer {
  grpc::Status status;
  std::vector<v1::VoxelizeResponse> messages;
  std::map<std::string, std::string> trailers;

  const v1::Accepted& accepted() const { return messages.front().accepted(); }
  const v1::Summary& summary() const { return messages.back().summary(); }
  std::string trailer(const std::string& key) const {
    const auto found = trailers.find(key);
    return found == trailers.end() ? "" : found->second;
  }
  std::vector<Brick> Bricks() const;
};

inline std::vector<Brick> Answer::Bricks() const {
  std::vector<Brick> bricks;
  for (const v1::VoxelizeResponse& message : messages) {
    const v1::BrickBatch& batch = message.bricks();
    EXPECT_EQ(batch.masks().size(), batch.brick_ijk_size() / 3 * sizeof(BrickMask));
    for (int n = 0; n < batch.brick_ijk_size() / 3; ++n) {
      Brick& brick = bricks.emplace_back();
      for (int m = 0; m < 3; ++m) brick.brick_ijk[static_cast<size_t>(m)] = batch.brick_ijk(3 * n + m);
      std::memcpy(brick.mask.data(), batch.masks().data() + n * sizeof(BrickMask), sizeof(BrickMask));
    }
  }
  return bricks;
}

class VoxelizeCall {
 public:
  explicit VoxelizeCall(v1::Voxelizer::Stub& stub) : context_(new grpc::ClientContext), stub_(stub) {}

  grpc::ClientContext& context() { return *context_; }
  Stream& stream() {
    if (!stream_) stream_ = stub_.Voxelize(context_.get());
    return *stream_;
  }

  VoxelizeCall& Send(const v1::VoxelizeRequest& message) {
    stream().Write(message);
    return *this;
  }

  Answer Receive() {
    Answer answer;
    for (v1::VoxelizeResponse message; stream().Read(&message);) answer.messages.push_back(message);
    answer.status = stream().Finish();
    for (const auto& [key, value] : context_->GetServerTrailingMetadata()) {
      answer.trailers.emplace(std::string(key.data(), key.size()), std::string(value.data(), value.size()));
    }
    return answer;
  }

  Answer HalfCloseAndReceive() {
    stream().WritesDone();
    return Receive();
  }

 private:
  std::unique_ptr<grpc::ClientContext> context_;
  v1::Voxelizer::Stub& stub_;
  std::unique_ptr<Stream> stream_;
};

inline Answer Voxelize(v1::Voxelizer::Stub& stub, const v1::VoxelizeSpec& spec, const std::string& mesh,
                       size_t piece_bytes = 1000) {
  VoxelizeCall call(stub);
  call.Send(SpecMessage(spec));
  for (size_t at = 0; at < mesh.size(); at += piece_bytes) call.Send(PieceMessage(mesh.substr(at, piece_bytes)));
  return call.HalfCloseAndReceive();
}

// A request for some 60 MB of bricks, after the client has read Accepted.
inline void StartBigJob(VoxelizeCall& call) {
  v1::VoxelizeSpec spec = Spec(3000);
  spec.set_minimal(false);
  call.Send(SpecMessage(spec)).Send(PieceMessage(SphereBytes())).stream().WritesDone();
  v1::VoxelizeResponse message;
  EXPECT_TRUE(call.stream().Read(&message) && message.has_accepted());
}

inline std::string Sha256(const std::string& bytes) {
  const MeshDigest digest = DigestOf(absl::Cord(bytes));
  return std::string(reinterpret_cast<const char*>(digest.data()), digest.size());
}

inline v1::PutMeshRequest PutSpec(const std::string& sha256, uint64_t bytes) {
  v1::PutMeshRequest request;
  request.mutable_spec()->set_mesh_sha256(sha256);
  request.mutable_spec()->set_mesh_bytes(bytes);
  return request;
}

// Sends the messages, whether they are still wanted or not.
inline grpc::Status PutMesh(v1::Voxelizer::Stub& stub, const std::vector<v1::PutMeshRequest>& messages,
                            v1::PutMeshResponse& response) {
  grpc::ClientContext context;
  const auto stream = stub.PutMesh(&context, &response);
  for (const auto& message : messages) {
    if (!stream->Write(message)) break;
  }
  stream->WritesDone();
  return stream->Finish();
}

inline std::vector<v1::PutMeshRequest> WholeMesh(const std::string& bytes) {
  std::vector<v1::PutMeshRequest> messages = {PutSpec(Sha256(bytes), bytes.size())};
  for (size_t at = 0; at < bytes.size(); at += 5000) messages.emplace_back().set_mesh_piece(bytes.substr(at, 5000));
  return messages;
}

class ServerTest : public testing::Test {
 protected:
  ServerTest() {
    options_.listen = {"unix:" + directory_ / "socket"};
    options_.threads = 2;
    options_.decoder = TestDecoders();
    options_.keepalive_time = absl::Seconds(1);
    options_.keepalive_timeout = absl::Seconds(1);
  }
  ~ServerTest() override {
    stub_.reset();
    server_.reset();
  }

  void Start() {
    auto server = VoxelServer::Start(options_);
    ASSERT_TRUE(server.ok()) << server.status();
    server_ = *std::move(server);
    stub_ = Connect();
  }

  // For clients that stop to take part, for longer than they have to answer a ping, and are to be kept all the same.
  void StartPatient() {
    options_.keepalive_time = options_.keepalive_timeout = absl::Seconds(100);
    Start();
  }

  std::unique_ptr<v1::Voxelizer::Stub> Connect() const {
    grpc::ChannelArguments arguments;
    arguments.SetMaxReceiveMessageSize(-1);
    arguments.SetInt("grpc.use_local_subchannel_pool", 1);  // a connection of its own
    return v1::Voxelizer::NewStub(
        grpc::CreateCustomChannel(server_->addresses()[0], grpc::InsecureChannelCredentials(), arguments));
  }

  TemporaryDirectory directory_;
  ServerOptions options_;
  std::unique_ptr<VoxelServer> server_;
  std::unique_ptr<v1::Voxelizer::Stub> stub_;
};

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_SERVER_CALLS_H_
