#include "server/health_server.h"

#include <grpc/grpc.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/impl/server_builder_option.h>

#include <chrono>
#include <utility>
#include <vector>

#include "latvox/v1/voxelizer.grpc.pb.h"
#include "server/endpoint.h"
#include "server/unix_socket.h"

namespace latvox {
namespace {

constexpr auto kCloseTimeout = std::chrono::milliseconds(500);

// Reflection is a plugin of every server that is built; not of this one.
class WithoutPlugins final : public grpc::ServerBuilderOption {
  void UpdateArguments(grpc::ChannelArguments* /*arguments*/) override {}
  void UpdatePlugins(std::vector<std::unique_ptr<grpc::ServerBuilderPlugin>>* plugins) override { plugins->clear(); }
};

class Server final : public HealthServer {
 public:
  Server(std::unique_ptr<grpc::Server> server, std::string address)
      : server_(std::move(server)), address_(std::move(address)) {
    server_->GetHealthCheckService()->SetServingStatus(v1::Voxelizer::service_full_name(), true);
  }
  ~Server() override {
    server_->Shutdown(std::chrono::system_clock::now() + kCloseTimeout);
    RemoveSocketFiles({address_});
  }

  const std::string& address() const override { return address_; }
  void SetNotServing() override { server_->GetHealthCheckService()->Shutdown(); }

 private:
  const std::unique_ptr<grpc::Server> server_;
  const std::string address_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<HealthServer>> HealthServer::Start(const std::string& address) {
  if (absl::Status status = CheckAddressIsFree(address); !status.ok()) return status;
  grpc::EnableDefaultHealthCheckService(true);
  grpc::ServerBuilder builder;
  builder.SetOption(std::make_unique<WithoutPlugins>());
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  int port = -1;
  builder.AddListeningPort(address, grpc::InsecureServerCredentials(), &port);
  auto server = builder.BuildAndStart();
  if (!server) return CannotListen(address);
  return std::make_unique<Server>(std::move(server), BoundAddress(address, port));
}

}  // namespace latvox
