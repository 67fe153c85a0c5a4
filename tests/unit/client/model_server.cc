#include "tests/unit/client/model_server.h"

#include <chrono>

#include "absl/strings/str_cat.h"
#include "client/internal/digest.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "latvox/mesh_id.h"

namespace latvox::client {
namespace {

using Stream = grpc::ServerReaderWriter<v1::VoxelizeResponse, v1::VoxelizeRequest>;

std::string Sha256(const std::string& bytes) {
  const MeshId id = MeshIdOf(bytes).value();
  return std::string(id.sha256.begin(), id.sha256.end());
}

Brick BrickOf(int tile) { return {{0, 0, 8 * tile}, {(uint64_t{2} << tile) - 1}}; }

v1::VoxelizeResponse AcceptedFor(int tiles) {
  v1::VoxelizeResponse response;
  v1::Accepted& accepted = *response.mutable_accepted();
  v1::Basis& basis = *accepted.mutable_grid()->mutable_basis();
  basis.mutable_a()->set_x(1);
  basis.mutable_b()->set_y(1);
  basis.mutable_c()->set_z(1);
  accepted.mutable_grid()->set_voxel_size(1);
  v1::Ijk& max = *accepted.mutable_index_box()->mutable_max();
  max.set_i(64);
  max.set_j(64);
  max.set_k(64 * tiles);
  accepted.mutable_mesh()->set_triangles(12);
  return response;
}

v1::VoxelizeResponse BatchOf(int tile, double progress) {
  const Brick brick = BrickOf(tile);
  v1::VoxelizeResponse response;
  for (const int32_t index : brick.brick_ijk) response.mutable_bricks()->add_brick_ijk(index);
  response.mutable_bricks()->set_masks(brick.mask.data(), sizeof(brick.mask));
  response.mutable_bricks()->set_progress(progress);
  return response;
}

v1::VoxelizeResponse SummaryOf(int first_tile, int tiles, uint64_t mesh_bytes) {
  v1::VoxelizeResponse response;
  v1::Summary& summary = *response.mutable_summary();
  Digest digest;
  for (int tile = first_tile; tile < tiles; ++tile) {
    digest.Add(BrickOf(tile));
    summary.set_voxels(summary.voxels() + tile + 1);
  }
  summary.set_bricks(tiles - first_tile);
  summary.set_tiles(tiles - first_tile);
  summary.set_mesh_bytes(mesh_bytes);
  summary.mutable_certificate()->set_digest(digest.ToHex());
  summary.mutable_certificate()->set_set("surface");
  return response;
}

}  // namespace

grpc::Status BrokenConnection() { return {grpc::StatusCode::UNAVAILABLE, "Socket closed"}; }

grpc::Status ServerSays(grpc::StatusCode code, const std::string& message, absl::Duration retry_after) {
  google::rpc::ErrorInfo info;
  info.set_domain("latvox");
  info.set_reason("A_REASON");
  google::rpc::Status details;
  details.add_details()->PackFrom(info);
  if (retry_after != absl::InfiniteDuration()) {
    google::rpc::RetryInfo retry;
    retry.mutable_retry_delay()->set_nanos(static_cast<int32_t>(absl::ToInt64Nanoseconds(retry_after)));
    details.add_details()->PackFrom(retry);
  }
  return {code, message, details.SerializeAsString()};
}

// One call of Voxelize.
class ModelServer::Run {
 public:
  Run(ModelServer& server, grpc::ServerContext& context, Stream& stream)
      : server_(server), context_(context), stream_(stream) {
    const std::lock_guard lock(server.mutex_);
    index_ = server.calls_.size();
    server.calls_.emplace_back();
    if (server.faults_.empty()) return;
    fault_ = server.faults_.front();
    server.faults_.pop_front();
  }

  grpc::Status Do() {
    if (Hit(Fault::At::kStart) || !Receive() || Hit(Fault::At::kAccepted)) return status_;
    Send(AcceptedFor(server_.tiles_));
    const int first = spec_.has_resume_after() ? spec_.resume_after().k() + 1 : 0;
    for (int tile = first; tile < server_.tiles_; ++tile) {
      if (Hit(Fault::At::kBatch, tile - first)) return status_;
      Send(BatchOf(tile, double(tile - first + 1) / server_.tiles_));
    }
    if (Hit(Fault::At::kSummary)) return status_;
    Send(SummaryOf(first, server_.tiles_, mesh_.size()));
    Hit(Fault::At::kEnd);
    return status_;
  }

 private:
  // Returns whether the fault is here; then status_ is its status.
  bool Hit(Fault::At at, int batch = 0) {
    if (fault_.at != at || fault_.batch != batch) return false;
    status_ = fault_.status;
    if (!fault_.pushback.empty()) context_.AddTrailingMetadata("grpc-retry-pushback-ms", fault_.pushback);
    if (!status_.ok()) return true;
    while (!context_.IsCancelled()) absl::SleepFor(absl::Milliseconds(1));
    status_ = grpc::Status::CANCELLED;
    return true;
  }

  bool Receive() {
    v1::VoxelizeRequest request;
    if (!stream_.Read(&request)) return false;
    spec_ = request.spec();
    for (int pieces = 0; stream_.Read(&request); ++pieces) {
      if (pieces == 1 && Hit(Fault::At::kUpload)) return false;
      mesh_ += request.mesh_piece();
    }
    const std::lock_guard lock(server_.mutex_);
    server_.calls_[index_] = {spec_, mesh_};
    server_.mesh_bytes_received_ += mesh_.size();
    if (!mesh_.empty()) return (status_ = server_.Keep(spec_.mesh_sha256(), mesh_)).ok();
    const auto kept = server_.meshes_.find(spec_.mesh_sha256());
    if (kept != server_.meshes_.end()) return mesh_ = kept->second, true;
    status_ = ServerSays(grpc::StatusCode::NOT_FOUND, "mesh_sha256: not here");
    return false;
  }

  void Send(v1::VoxelizeResponse response) {
    if (fault_.change) fault_.change(response);
    stream_.Write(response);
  }

  ModelServer& server_;
  grpc::ServerContext& context_;
  Stream& stream_;
  size_t index_ = 0;
  Fault fault_;
  v1::VoxelizeSpec spec_;
  std::string mesh_;
  grpc::Status status_;
};

ModelServer::ModelServer(std::deque<Fault> faults, int tiles, const std::string& address)
    : tiles_(tiles), faults_(std::move(faults)) {
  int port = 0;
  grpc::ServerBuilder builder;
  builder.AddListeningPort(address, grpc::InsecureServerCredentials(), &port);
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 0);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_PING_STRIKES, 0);
  builder.RegisterService(this);
  server_ = builder.BuildAndStart();
  address_ = absl::StrCat("127.0.0.1:", port);
}

ModelServer::~ModelServer() { Stop(); }

void ModelServer::Stop() { server_->Shutdown(std::chrono::system_clock::now()); }

std::string ModelServer::DigestOfAll(int tiles) { return SummaryOf(0, tiles, 0).summary().certificate().digest(); }

std::vector<SeenCall> ModelServer::calls() const {
  const std::lock_guard lock(mutex_);
  return calls_;
}

uint64_t ModelServer::mesh_bytes_received() const {
  const std::lock_guard lock(mutex_);
  return mesh_bytes_received_;
}

void ModelServer::DropMeshes() {
  const std::lock_guard lock(mutex_);
  meshes_.clear();
}

void ModelServer::Refuse(int calls, const grpc::Status& status) {
  const std::lock_guard lock(mutex_);
  refusals_ = calls;
  refusal_ = status;
}

int ModelServer::refusals_left() const {
  const std::lock_guard lock(mutex_);
  return refusals_;
}

grpc::Status ModelServer::Refusal() {
  const std::lock_guard lock(mutex_);
  return refusals_ == 0 ? grpc::Status::OK : (--refusals_, refusal_);
}

// Precondition: the caller holds mutex_.
grpc::Status ModelServer::Keep(const std::string& sha256, const std::string& mesh) {
  if (Sha256(mesh) != sha256) return ServerSays(grpc::StatusCode::INVALID_ARGUMENT, "mesh_sha256 is another");
  meshes_[sha256] = mesh;
  return grpc::Status::OK;
}

grpc::Status ModelServer::Voxelize(grpc::ServerContext* context, Stream* stream) {
  return Run(*this, *context, *stream).Do();
}

grpc::Status ModelServer::PutMesh(grpc::ServerContext*, grpc::ServerReader<v1::PutMeshRequest>* stream,
                                  v1::PutMeshResponse* response) {
  if (grpc::Status status = Refusal(); !status.ok()) return status;
  v1::PutMeshRequest request;
  stream->Read(&request);
  const v1::PutMeshSpec spec = request.spec();
  {
    const std::lock_guard lock(mutex_);
    response->set_already_stored(meshes_.count(spec.mesh_sha256()) > 0);
  }
  if (response->already_stored()) return grpc::Status::OK;
  std::string mesh;
  while (stream->Read(&request)) mesh += request.mesh_piece();
  const std::lock_guard lock(mutex_);
  mesh_bytes_received_ += mesh.size();
  if (mesh.size() != spec.mesh_bytes()) return ServerSays(grpc::StatusCode::INVALID_ARGUMENT, "mesh_bytes is another");
  return Keep(spec.mesh_sha256(), mesh);
}

grpc::Status ModelServer::Pixelize(grpc::ServerContext*, const v1::PixelizeRequest*, v1::PixelizeResponse* response) {
  response->mutable_grid()->mutable_basis()->mutable_a()->set_x(1);
  response->mutable_grid()->mutable_basis()->mutable_b()->set_y(1);
  response->mutable_grid()->set_pixel_size(1);
  response->set_digest(Digest().ToHex());
  return Refusal();
}

grpc::Status ModelServer::GetLimits(grpc::ServerContext*, const v1::GetLimitsRequest*,
                                    v1::GetLimitsResponse* response) {
  response->set_max_extent(65536);
  return Refusal();
}

}  // namespace latvox::client
