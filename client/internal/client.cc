#include "latvox/client.h"

#include <memory>
#include <utility>

#include "absl/strings/str_split.h"
#include "client/internal/address.h"
#include "client/internal/connection.h"
#include "client/internal/printable.h"
#include "client/internal/private_server.h"
#include "client/internal/remote_service.h"
#include "client/internal/request_check.h"

namespace latvox::client {
namespace {

// A call with handlers that keep everything.
template <class Mesh>
absl::StatusOr<Voxelization> Gather(const Client& client, const VoxelizeRequest& request, const Mesh& mesh,
                                    const CallOptions& options) {
  Voxelization all;
  const auto accept = [&all, &request](const Accepted& accepted) {
    all.accepted = accepted;
    for (const Field field : request.fields) all.fields.push_back(accepted.NoValues(field));
    return absl::OkStatus();
  };
  const auto take = [&all](const BrickBatch& batch) {
    const auto& [bricks, progress, fields] = batch;  // all members of a batch
    all.bricks.insert(all.bricks.end(), bricks.begin(), bricks.end());
    for (size_t n = 0; n < fields.size(); ++n) {
      std::vector<std::byte>& bytes = all.fields[n].bytes;
      bytes.insert(bytes.end(), fields[n].bytes.begin(), fields[n].bytes.end());
    }
    return absl::OkStatus();
  };
  absl::StatusOr<Summary> summary = client.Voxelize(request, mesh, {.on_accepted = accept, .on_bricks = take}, options);
  if (!summary.ok()) return summary.status();
  all.summary = *std::move(summary);
  return all;
}

}  // namespace

Client::Client(std::shared_ptr<VoxelService> service) : service_(std::move(service)) {}
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
    if (absl::Status status = CheckAddress(address); !status.ok()) return PrintableStatus(status);
  }
  if (addresses.empty()) return absl::InvalidArgumentError("addresses: there is none to connect to");
  auto connection = Connection::Open(addresses, options, connection_options);
  if (!connection.ok()) return PrintableStatus(connection.status());
  return Client(std::make_shared<RemoteService>(*std::move(connection)));
}

absl::StatusOr<Client> Client::StartPrivate(const PrivateServerOptions& server_options, const CallOptions& options) {
  auto server = PrivateServer::Start(server_options);
  if (!server.ok()) return PrintableStatus(server.status());
  if (absl::Status status = (*server)->AwaitReady(options); !status.ok()) return PrintableStatus(status);
  absl::StatusOr<Client> client = Connect((*server)->address(), options);
  if (!client.ok()) return client.status();
  (*server)->RemoveDirectory();
  struct Both {
    std::unique_ptr<PrivateServer> server;
    std::shared_ptr<VoxelService> service;  // destroyed first: the connection ends before its server
  };
  const auto both = std::make_shared<Both>(Both{*std::move(server), std::move(client->service_)});
  return Client(std::shared_ptr<VoxelService>(both, both->service.get()));
}

absl::StatusOr<Summary> Client::Voxelize(const VoxelizeRequest& request, std::string_view mesh_bytes,
                                         const VoxelizeHandlers& handlers, const CallOptions& options) const {
  if (absl::Status status = CheckMesh(mesh_bytes); !status.ok()) return status;
  if (absl::Status status = CheckRequest(request); !status.ok()) return status;
  const absl::StatusOr<MeshId> mesh = MeshIdOf(mesh_bytes);
  if (!mesh.ok()) return mesh.status();
  return service_->Voxelize(request, {*mesh, mesh_bytes}, handlers, options);
}

absl::StatusOr<Summary> Client::Voxelize(const VoxelizeRequest& request, const MeshId& mesh,
                                         const VoxelizeHandlers& handlers, const CallOptions& options) const {
  if (absl::Status status = CheckRequest(request); !status.ok()) return status;
  return service_->Voxelize(request, {mesh, std::nullopt}, handlers, options);
}

absl::StatusOr<Voxelization> Client::VoxelizeAll(const VoxelizeRequest& request, std::string_view mesh_bytes,
                                                 const CallOptions& options) const {
  return Gather(*this, request, mesh_bytes, options);
}

absl::StatusOr<Voxelization> Client::VoxelizeAll(const VoxelizeRequest& request, const MeshId& mesh,
                                                 const CallOptions& options) const {
  return Gather(*this, request, mesh, options);
}

BrickStream Client::Stream(VoxelizeRequest request, std::string mesh_bytes, const CallOptions& options) const {
  return BrickStream(
      [service = service_, request, mesh = std::move(mesh_bytes)](const VoxelizeHandlers& handlers,
                                                                  const CallOptions& its_options) {
        return Client(service).Voxelize(request, mesh, handlers, its_options);
      },
      options);
}

BrickStream Client::Stream(VoxelizeRequest request, const MeshId& mesh, const CallOptions& options) const {
  return BrickStream(
      [service = service_, request, mesh](const VoxelizeHandlers& handlers, const CallOptions& its_options) {
        return Client(service).Voxelize(request, mesh, handlers, its_options);
      },
      options);
}

absl::StatusOr<MeshId> Client::PutMesh(std::string_view mesh_bytes, const CallOptions& options) const {
  if (absl::Status status = CheckMesh(mesh_bytes); !status.ok()) return status;
  absl::StatusOr<MeshId> mesh = MeshIdOf(mesh_bytes);
  if (!mesh.ok()) return mesh;
  if (absl::Status status = service_->PutMesh(*mesh, mesh_bytes, options); !status.ok()) return status;
  return mesh;
}

absl::StatusOr<Pixelization> Client::Pixelize(const PixelizeRequest& request, const CallOptions& options) const {
  if (absl::Status status = CheckRequest(request); !status.ok()) return status;
  return service_->Pixelize(request, options);
}

absl::StatusOr<Limits> Client::GetLimits(const CallOptions& options) const { return service_->GetLimits(options); }

absl::StatusOr<bool> Client::Health(const CallOptions& options) const { return service_->Health(options); }

}  // namespace latvox::client
