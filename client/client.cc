#include "client/client.h"

#include <grpcpp/generic/generic_stub.h>

#include <future>
#include <utility>

#include "absl/strings/str_split.h"
#include "client/attempt.h"
#include "client/connection.h"
#include "client/mesh_pieces.h"
#include "client/plane_wire.h"
#include "client/tries.h"
#include "client/voxelize_call.h"
#include "client/wire.h"

namespace latvox::client {

Client::Client(std::unique_ptr<Connection> connection) : connection_(std::move(connection)) {}
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;
Client::~Client() = default;

absl::StatusOr<Client> Client::Connect(const std::string& addresses, const CallOptions& options,
                                       const ConnectionOptions& connection_options) {
  return Connect(std::vector<std::string>(absl::StrSplit(addresses, ',')), options, connection_options);
}

absl::StatusOr<Client> Client::Connect(const std::vector<std::string>& addresses, const CallOptions& options,
                                       const ConnectionOptions& connection_options) {
  for (const std::string& address : addresses) {
    if (address.empty()) return absl::InvalidArgumentError("address: one is empty; it is HOST:PORT or unix:PATH");
  }
  if (addresses.empty()) return absl::InvalidArgumentError("addresses: there is none to connect to");
  auto connection = Connection::Open(addresses, options, connection_options);
  if (!connection.ok()) return connection.status();
  return Client(*std::move(connection));
}

absl::StatusOr<Summary> Client::Voxelize(const VoxelizeRequest& request, std::string_view mesh_drc,
                                         const VoxelizeHandlers& handlers, const CallOptions& options) const {
  const absl::StatusOr<MeshId> mesh = MeshIdOf(mesh_drc);
  if (!mesh.ok()) return mesh.status();
  return VoxelizeCall(*connection_, request, *mesh, mesh_drc, handlers, options).Run();
}

absl::StatusOr<Summary> Client::Voxelize(const VoxelizeRequest& request, const MeshId& mesh,
                                         const VoxelizeHandlers& handlers, const CallOptions& options) const {
  return VoxelizeCall(*connection_, request, mesh, std::nullopt, handlers, options).Run();
}

absl::StatusOr<MeshId> Client::PutMesh(std::string_view mesh_drc, const CallOptions& options) const {
  absl::StatusOr<MeshId> mesh = MeshIdOf(mesh_drc);
  if (!mesh.ok()) return mesh;
  v1::PutMeshRequest first;
  first.mutable_spec()->set_mesh_sha256(mesh->sha256.data(), mesh->sha256.size());
  first.mutable_spec()->set_mesh_bytes(mesh->bytes);
  const absl::Status status = Repeat(*connection_, options, [&](size_t server) {
    Attempt attempt(options, connection_->credentials());
    v1::PutMeshResponse response;
    const auto stream = connection_->endpoint(server).stub->PutMesh(&attempt.context(), &response);
    MeshPieces<v1::PutMeshRequest> pieces(mesh_drc);
    // A write that fails means that the call is over: the server has the mesh already, for one.
    bool open = stream->Write(first);
    while (open && !pieces.empty()) open = stream->Write(pieces.Next());
    if (open) stream->WritesDone();
    AttemptEnd end = attempt.End(stream->Finish());
    if (end.status.ok()) connection_->Remember(server, *mesh);
    return end;
  });
  if (!status.ok()) return status;
  return mesh;
}

absl::StatusOr<Pixelization> Client::Pixelize(const PixelizeRequest& request, const CallOptions& options) const {
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

absl::StatusOr<Limits> Client::GetLimits(const CallOptions& options) const {
  v1::GetLimitsResponse response;
  const absl::Status status = Repeat(*connection_, options, [&](size_t server) {
    Attempt attempt(options, connection_->credentials());
    const v1::GetLimitsRequest message;
    return attempt.End(connection_->endpoint(server).stub->GetLimits(&attempt.context(), message, &response));
  });
  if (!status.ok()) return status;
  return FromProto(response);
}

// grpc.health.v1 written out by hand, as two bytes at most are spoken: the request {} asks for the whole server, and
// the answer's field 1 is the status, 1 for SERVING.
absl::StatusOr<bool> Client::Health(const CallOptions& options) const {
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
