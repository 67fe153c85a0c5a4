// A server in the test's process that keeps the protocol, meshes and resumption included, except for the faults that a
// test sets.
#ifndef LATVOX_TESTS_UNIT_CLIENT_MODEL_SERVER_H_
#define LATVOX_TESTS_UNIT_CLIENT_MODEL_SERVER_H_

#include <grpcpp/grpcpp.h>

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "absl/time/time.h"
#include "latvox/v1/voxelizer.grpc.pb.h"

namespace latvox::client {

// The fault of one call.
struct Fault {
  enum class At { kNever, kStart, kUpload, kAccepted, kBatch, kSummary, kEnd };

  At at = At::kNever;         // the fault comes before the spec, the mesh's second piece, Accepted, ..., the good end
  int batch = 0;              // for kBatch: its number in this call, from 0
  grpc::Status status = {};   // the end of the call; OK: it hangs until the call is over for another reason
  std::string pushback = {};  // if given: the trailer grpc-retry-pushback-ms
  std::function<void(v1::VoxelizeResponse&)> change = {};  // changes every answer before the fault
};

// Returns gRPC's status of a broken connection.
grpc::Status BrokenConnection();

// Returns a status of a latvox server itself, with ErrorInfo, and with RetryInfo if `retry_after` is finite.
grpc::Status ServerSays(grpc::StatusCode code, const std::string& message,
                        absl::Duration retry_after = absl::InfiniteDuration());

// The input of one call.
struct SeenCall {
  v1::VoxelizeSpec spec;
  std::string mesh;  // the bytes that arrived
};

class ModelServer final : public v1::Voxelizer::Service {
 public:
  // The result has `tiles` tiles, one in each batch: tile 0,0,n has n + 1 voxels. Fault n is that of call n; calls
  // without one end well.
  explicit ModelServer(std::deque<Fault> faults = {}, int tiles = 4, const std::string& address = "127.0.0.1:0");
  ~ModelServer() override;

  const std::string& address() const { return address_; }
  static std::string DigestOfAll(int tiles = 4);

  std::vector<SeenCall> calls() const;
  uint64_t mesh_bytes_received() const;
  void DropMeshes();
  // The next `calls` calls other than Voxelize end with `status`.
  void Refuse(int calls, const grpc::Status& status);
  int refusals_left() const;
  void Stop();  // also refuses new connections

  grpc::Status Voxelize(grpc::ServerContext* context,
                        grpc::ServerReaderWriter<v1::VoxelizeResponse, v1::VoxelizeRequest>* stream) override;
  grpc::Status PutMesh(grpc::ServerContext* context, grpc::ServerReader<v1::PutMeshRequest>* stream,
                       v1::PutMeshResponse* response) override;
  grpc::Status Pixelize(grpc::ServerContext* context, const v1::PixelizeRequest* request,
                        v1::PixelizeResponse* response) override;
  grpc::Status GetLimits(grpc::ServerContext* context, const v1::GetLimitsRequest* request,
                         v1::GetLimitsResponse* response) override;

 private:
  class Run;

  grpc::Status Keep(const std::string& sha256, const std::string& mesh);
  grpc::Status Refusal();

  const int tiles_;
  std::string address_;
  std::unique_ptr<grpc::Server> server_;
  mutable std::mutex mutex_;
  std::deque<Fault> faults_;
  std::vector<SeenCall> calls_;
  std::map<std::string, std::string> meshes_;  // by SHA-256
  uint64_t mesh_bytes_received_ = 0;
  int refusals_ = 0;
  grpc::Status refusal_;
};

}  // namespace latvox::client

#endif  // LATVOX_TESTS_UNIT_CLIENT_MODEL_SERVER_H_
