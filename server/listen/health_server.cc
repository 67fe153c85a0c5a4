#include "server/listen/health_server.h"

#include <grpc/grpc.h>
#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/impl/server_builder_option.h>

#include <chrono>
#include <utility>
#include <vector>

#include "latvox/v1/voxelizer.grpc.pb.h"
#include "server/base/endpoint.h"
#include "server/base/unix_socket.h"
#include "server/guard/frame_guard.h"

namespace latvox {
namespace {

constexpr auto kProbesCloseTimeout = std::chrono::milliseconds(500);
constexpr int kMostRequestBytes = 4096;
// Probes are quick. Others shall not hold files.
constexpr int kHandshakeMs = 10'000, kKeepaliveMs = 10'000;

// Reflection is a plugin of every server that is built, but not of this one.
class WithoutPlugins final : public grpc::ServerBuilderOption {
  void UpdateArguments(grpc::ChannelArguments* /*arguments*/) override {}
  void UpdatePlugins(std::vector<std::unique_ptr<grpc::ServerBuilderPlugin>>* plugins) override { plugins->clear(); }
};

class ProbedServer final : public HealthServer {
 public:
  // Returns UNAVAILABLE naming the address.
  absl::Status Listen(const std::string& address);

  ~ProbedServer() override {
    if (!server_) return;
    server_->Shutdown(std::chrono::system_clock::now() + kProbesCloseTimeout);
    socket_files_.Remove();
  }

  const std::string& address() const override { return address_; }
  const SocketFiles& socket_files() const override { return socket_files_; }
  void SetNotServing() override { server_->GetHealthCheckService()->Shutdown(); }

 private:
  // gRPC builds no server without a service of its user. This one answers UNIMPLEMENTED to all calls except those of
  // the health service.
  grpc::CallbackGenericService nothing_;
  std::unique_ptr<grpc::Server> server_;
  std::string address_;
  SocketFiles socket_files_;
};

absl::Status ProbedServer::Listen(const std::string& address) {
  if (absl::Status status = CheckAddressIsFree(address); !status.ok()) return status;
  grpc::ServerBuilder builder;
  builder.SetOption(std::make_unique<WithoutPlugins>());
  builder.RegisterCallbackGenericService(&nothing_);
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  // Like the server; requests for a service's health are small.
  WithoutCompression(builder);
  builder.SetMaxReceiveMessageSize(kMostRequestBytes);
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, static_cast<int>(kMostStreams));
  builder.AddChannelArgument(GRPC_ARG_MAX_METADATA_SIZE, static_cast<int>(kMostHeaderBytes));
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, kHandshakeMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  int port = -1;
  builder.AddListeningPort(ProvisionalAddress(address), grpc::InsecureServerCredentials(), &port);
  server_ = builder.BuildAndStart();
  if (!server_) return CannotListen(address);
  if (absl::Status status = socket_files_.MoveIntoPlace(address); !status.ok())
    return CannotListen(address, status.message());
  address_ = BoundAddress(address, port);
  server_->GetHealthCheckService()->SetServingStatus(v1::Voxelizer::service_full_name(), true);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::unique_ptr<HealthServer>> HealthServer::Start(const std::string& address) {
  grpc::EnableDefaultHealthCheckService(true);
  auto server = std::make_unique<ProbedServer>();
  if (absl::Status status = server->Listen(address); !status.ok()) return status;
  return server;
}

}  // namespace latvox
