#include "server/server.h"

#include <grpc/grpc.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "server/authenticator.h"
#include "server/call_registry.h"
#include "server/draco_decoder.h"
#include "server/file_watch.h"
#include "server/metrics.h"
#include "server/metrics_server.h"
#include "server/service.h"
#include "server/unix_socket.h"

namespace latvox {
namespace {

// How long stopped calls may take to end. They end within a tile's time, unless a decode is under way.
constexpr absl::Duration kStopTimeout = absl::Seconds(5);

// How long connections may take to close that have no call of ours, such as watchers of the health service.
constexpr auto kCloseTimeout = std::chrono::milliseconds(500);

int ToMilliseconds(absl::Duration duration) { return static_cast<int>(absl::ToInt64Milliseconds(duration)); }

absl::Status CannotListen(const std::string& address, absl::string_view why) {
  return absl::UnavailableError(absl::StrCat("cannot listen on ", address, ": ", why));
}

// "HOST:0" with the port that was chosen.
std::string BoundAddress(const std::string& address, int port) {
  if (SocketPathOf(address) || !absl::EndsWith(address, ":0")) return address;
  return absl::StrCat(address.substr(0, address.size() - 1), port);
}

class Server final : public VoxelServer {
 public:
  explicit Server(const ServerOptions& options)
      : options_(options),
        threads_(options.threads > 0 ? options.threads : oneapi::tbb::info::default_concurrency()),
        parallelism_(oneapi::tbb::global_control::max_allowed_parallelism, static_cast<size_t>(threads_) + 1),
        arena_(threads_, 0),
        registry_(options.limits.max_jobs),
        authenticator_(options.token_file),
        service_({options_.limits, decoder_, arena_, registry_, metrics_}, authenticator_) {
    metrics_.AddGauge("latvox_jobs_running", "Calls in progress.", [this] { return registry_.size(); });
    metrics_.AddGauge("latvox_jobs_max", "Jobs that may run at once.", [this] { return options_.limits.max_jobs; });
    watch_.Add({options_.token_file}, [this] { authenticator_.Reload(); });
  }

  ~Server() override { Stop(absl::ZeroDuration()); }

  absl::Status Listen();

  const std::vector<std::string>& addresses() const override { return addresses_; }
  std::string metrics_address() const override { return metrics_server_ ? metrics_server_->address() : ""; }
  size_t calls() const override { return registry_.size(); }
  void Reload() override { authenticator_.Reload(); }
  bool Stop(absl::Duration grace) override;

 private:
  void Configure(grpc::ServerBuilder& builder) const;

  const ServerOptions options_;
  const int threads_;
  // oneTBB starts one worker less than this; reserving no place for other threads in the arena, all of its threads are
  // workers.
  const oneapi::tbb::global_control parallelism_;
  oneapi::tbb::task_arena arena_;
  const DracoDecoder decoder_;
  CallRegistry registry_;
  Authenticator authenticator_;
  Metrics metrics_;
  VoxelizerService service_;
  std::vector<std::string> addresses_;
  std::unique_ptr<grpc::Server> server_;
  FileWatch watch_;
  std::unique_ptr<MetricsServer> metrics_server_;
};

void Server::Configure(grpc::ServerBuilder& builder) const {
  const auto message_bytes = std::min<uint64_t>(options_.limits.max_message_bytes, std::numeric_limits<int>::max());
  builder.SetMaxReceiveMessageSize(static_cast<int>(message_bytes));
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, ToMilliseconds(options_.keepalive_time));
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, ToMilliseconds(options_.keepalive_timeout));
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  // Clients may ping as they like.
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 0);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_PING_STRIKES, 0);
  // Otherwise a second server would share the port silently.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
}

absl::Status Server::Listen() {
  if (options_.listen.empty()) return absl::InvalidArgumentError("there is no address to listen on");
  if (absl::Status status = authenticator_.Read(); !status.ok()) return status;
  grpc::ServerBuilder builder;
  Configure(builder);
  builder.RegisterService(&service_);
  std::vector<int> ports(options_.listen.size(), -1);
  for (size_t n = 0; n < ports.size(); ++n) {
    const std::string& address = options_.listen[n];
    if (const auto path = SocketPathOf(address)) {
      if (absl::Status status = CheckSocketPathIsFree(*path); !status.ok()) {
        return CannotListen(address, status.message());
      }
    }
    builder.AddListeningPort(address, grpc::InsecureServerCredentials(), &ports[n]);
  }
  server_ = builder.BuildAndStart();
  if (!server_) {
    const auto failed = std::find_if(ports.begin(), ports.end(), [](int port) { return port <= 0; }) - ports.begin();
    const size_t n = std::min(static_cast<size_t>(failed), ports.size() - 1);
    return CannotListen(options_.listen[n], "the address is in use, not of this machine, or not permitted");
  }
  if (!options_.metrics_listen.empty()) {
    auto metrics_server = MetricsServer::Start(options_.metrics_listen, metrics_);
    if (!metrics_server.ok()) return metrics_server.status();
    metrics_server_ = *std::move(metrics_server);
  }
  watch_.Start();
  for (size_t n = 0; n < ports.size(); ++n) addresses_.push_back(BoundAddress(options_.listen[n], ports[n]));
  server_->GetHealthCheckService()->SetServingStatus(v1::Voxelizer::service_full_name(), true);
  return absl::OkStatus();
}

bool Server::Stop(absl::Duration grace) {
  if (!server_) return true;
  server_->GetHealthCheckService()->Shutdown();
  registry_.Close();
  if (!registry_.WaitUntilEmpty(grace)) {
    registry_.StopAll();
    // grpc::Server::Shutdown never returns while a call is open, whatever its deadline.
    if (!registry_.WaitUntilEmpty(kStopTimeout)) return false;
  }
  server_->Shutdown(std::chrono::system_clock::now() + kCloseTimeout);
  server_.reset();
  RemoveSocketFiles(addresses_);
  return true;
}

}  // namespace

absl::Status VoxelServer::Check(const ServerOptions& options) {
  if (options.listen.empty()) return absl::InvalidArgumentError("there is no address to listen on");
  return Authenticator(options.token_file).Read();
}

absl::StatusOr<std::unique_ptr<VoxelServer>> VoxelServer::Start(const ServerOptions& options) {
  // The library stays up until the process ends: to shut it down takes 10 s if a peer had stopped reading.
  static const bool kept_up = (grpc_init(), true);
  static_cast<void>(kept_up);
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  auto server = std::make_unique<Server>(options);
  if (absl::Status status = server->Listen(); !status.ok()) return status;
  return server;
}

}  // namespace latvox
