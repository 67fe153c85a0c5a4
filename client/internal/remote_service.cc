#include "client/internal/remote_service.h"

#include <grpcpp/generic/generic_stub.h>

#include <future>
#include <utility>

#include "client/internal/attempt.h"
#include "client/internal/mesh_pieces.h"
#include "client/internal/plane_wire.h"
#include "client/internal/tries.h"
#include "client/internal/voxelize_call.h"
#include "client/internal/wire.h"

namespace latvox::client {

RemoteService::RemoteService(std::unique_ptr<Connection> connection) : connection_(std::move(connection)) {}

absl::StatusOr<Summary> RemoteService::Voxelize(const VoxelizeRequest& request, const MeshInput& mesh,
                                                const VoxelizeHandlers& handlers, const CallOptions& options) {
  return VoxelizeCall(*connection_, request, mesh.id, mesh.drc, handlers, options).Run();
}

absl::Status RemoteService::PutMesh(const MeshId& mesh, std::string_view mesh_bytes, const CallOptions& options) {
  v1::PutMeshRequest first;
  first.mutable_spec()->set_mesh_sha256(mesh.sha256.data(), mesh.sha256.size());
  first.mutable_spec()->set_mesh_bytes(mesh.bytes);
  return Repeat(*connection_, options, [&](size_t server) {
    Attempt attempt(options, connection_->credentials());
    v1::PutMeshResponse response;
    const auto stream = connection_->endpoint(server).stub->PutMesh(&attempt.context(), &response);
    MeshPieces<v1::PutMeshRequest> pieces(mesh_bytes);
    // A failed write means that the call is over, for example because the server has the mesh already.
    bool open = stream->Write(first);
    while (open && !pieces.empty()) open = stream->Write(pieces.Next());
    if (open) stream->WritesDone();
    AttemptEnd end = attempt.End(stream->Finish());
    if (end.status.ok()) connection_->Remember(server, mesh);
    return end;
  });
}

absl::StatusOr<Pixelization> RemoteService::Pixelize(const PixelizeRequest& request, const CallOptions& options) {
  const v1::PixelizeRequest message = ToProto(request);
  v1::PixelizeResponse response;
  const absl::Status status = Repeat(*connection_, options, [&](size_t server) {
    Attempt attempt(options, connection_->credentials());
    return attempt.End(connection_->endpoint(server).stub->Pixelize(&attempt.context(), message, &response));
  });
  if (!status.ok()) return status;
  absl::StatusOr<Pixelization> pixelization = FromProto(response);
  if (pixelization.ok()) {
    pixelization->bytes_sent = message.ByteSizeLong();
    pixelization->bytes_received = response.ByteSizeLong();
  }
  return pixelization;
}

absl::StatusOr<Limits> RemoteService::GetLimits(const CallOptions& options) {
  v1::GetLimitsResponse response;
  const absl::Status status = Repeat(*connection_, options, [&](size_t server) {
    Attempt attempt(options, connection_->credentials());
    const v1::GetLimitsRequest message;
    return attempt.End(connection_->endpoint(server).stub->GetLimits(&attempt.context(), message, &response));
  });
  if (!status.ok()) return status;
  return FromProto(response);
}

// grpc.health.v1 by hand, because it needs two bytes at most: the request {} asks for the whole server, and the
// answer's field 1 is the status, 1 for SERVING.
absl::StatusOr<bool> RemoteService::Health(const CallOptions& options) {
  Attempt attempt(options, connection_->credentials());
  const grpc::Slice nothing;
  const grpc::ByteBuffer request(&nothing, 1);
  grpc::ByteBuffer response;
  std::promise<grpc::Status> done;
  const size_t server = *connection_->Pick(std::vector<bool>(connection_->size(), false), nullptr);
  grpc::GenericStub(connection_->endpoint(server).channel)
      .UnaryCall(&attempt.context(), "/grpc.health.v1.Health/Check", grpc::StubOptions(), &request, &response,
                 [&done](grpc::Status status) { done.set_value(std::move(status)); });
  if (AttemptEnd end = attempt.End(done.get_future().get()); !end.status.ok()) return end.status;
  grpc::Slice slice;
  if (!response.DumpToSingleSlice(&slice).ok()) return absl::DataLossError("the health answer cannot be read");
  const std::string_view bytes(reinterpret_cast<const char*>(slice.begin()), slice.size());
  return bytes == std::string_view("\x08\x01", 2);
}

}  // namespace latvox::client
