#include "server/listen/server.h"

#include <grpc/grpc.h>
#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/resource_quota.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "server/access/access.h"
#include "server/base/endpoint.h"
#include "server/base/log.h"
#include "server/base/process_facts.h"
#include "server/base/unix_socket.h"
#include "server/calls/call_registry.h"
#include "server/calls/metrics.h"
#include "server/calls/service.h"
#include "server/decode/decoder_pool.h"
#include "server/decode/mesh_store.h"
#include "server/guard/connection_guard.h"
#include "server/guard/connections.h"
#include "server/listen/health_server.h"
#include "server/listen/metrics_server.h"
#include "server/listen/shares.h"
#include "server/listen/socket_acceptor.h"
#include "server/work/memory_budget.h"
#include "server/work/unfinished_uploads.h"
#include "server/work/work_lanes.h"
#include "server/work/work_queue.h"

namespace latvox {
namespace {

// The time for stopped calls to end. They end within a tile's time.
constexpr absl::Duration kStopTimeout = absl::Seconds(5);

// The time to close for connections without our calls, such as watchers of the health service.
constexpr auto kCloseTimeout = std::chrono::milliseconds(500);

int ToMilliseconds(absl::Duration duration) { return static_cast<int>(absl::ToInt64Milliseconds(duration)); }

// For a TLS handshake and the first frame. A client that takes longer holds a file for nothing.
constexpr absl::Duration kHandshakeTimeout = absl::Seconds(20);
constexpr int kReflectionThreads = 16;

absl::Status CheckAddresses(const ServerOptions& options) {
  const bool has_sockets = !options.sockets.empty();
  if (options.listen.empty() && !has_sockets) return absl::InvalidArgumentError("there is no address to listen on");
  std::vector<std::string> addresses = options.listen;
  for (const std::string& address : {options.health_listen, options.metrics_listen}) {
    if (!address.empty()) addresses.push_back(address);
  }
  const std::string& metrics = options.metrics_listen;
  if (IsUnixSocket(metrics) || absl::StartsWith(metrics, ":")) {
    return absl::InvalidArgumentError(
        absl::StrCat("cannot listen on \"", metrics, "\" for metrics: that is no HOST:PORT with an IP address"));
  }
  for (const std::string& address : addresses) {
    if (absl::Status status = CheckAddress(address); !status.ok()) return status;
  }
  return absl::OkStatus();
}

// Returns the addresses that clients reach the server at.
std::vector<std::string> ServedAddresses(const ServerOptions& options) {
  if (options.sockets.empty()) return options.listen;
  std::vector<std::string> addresses;
  for (const ActivatedSocket& socket : options.sockets) addresses.push_back(socket.address);
  return addresses;
}

// A client certificate protects no address without TLS, which are those of the health service and Unix sockets.
absl::Status CheckAllExposed(const ServerOptions& options) {
  const std::string lack = LackOfDefense();
  const bool behind_proxy = options.access.behind_proxy, mutual_tls = !options.access.tls.client_ca.empty();
  for (const std::string& address : ServedAddresses(options)) {
    if (absl::Status status = CheckExposed(address, lack, behind_proxy, mutual_tls); !status.ok()) return status;
  }
  if (options.health_listen.empty()) return absl::OkStatus();
  return CheckExposed(options.health_listen, lack, behind_proxy, false);
}

class Server final : public VoxelServer {
 public:
  Server(const ServerOptions& options, std::unique_ptr<DecoderPool> decoders)
      : options_(options),
        threads_(ThreadsOf(options)),
        parallelism_(oneapi::tbb::global_control::max_allowed_parallelism, 2 * static_cast<size_t>(threads_) + 1),
        quick_(threads_, 0),
        bulk_(threads_, options_.bulk_niceness),
        decoders_(std::move(decoders)),
        meshes_(options_.limits.mesh_store_bytes, !options_.decode_always),
        memory_(options_.limits.memory_budget_bytes),
        uploads_(memory_, options_.limits.mesh_store_bytes),
        registry_({options_.limits.max_jobs, options_.limits.max_queued_jobs, options_.limits.max_jobs_per_client}),
        access_(options_.access),
        service_({options_.limits, *decoders_, meshes_, uploads_, memory_, quick_, bulk_, registry_, metrics_,
                  options_.build},
                 access_.authenticator()) {
    AddMetrics();
  }

  // After a call is over, a task may still run its last lines, or hold the last reference to objects that are about to
  // go.
  ~Server() override {
    Stop(absl::ZeroDuration());
    bulk_.Wait();
    quick_.Wait();  // tasks of the other queue pass work on to this one
  }

  absl::Status Listen();

  const std::vector<std::string>& addresses() const override { return addresses_; }
  const SocketFiles& socket_files() const override { return socket_files_; }
  std::string metrics_address() const override { return metrics_server_ ? metrics_server_->address() : ""; }
  std::string health_address() const override { return health_server_ ? health_server_->address() : ""; }
  size_t calls() const override { return registry_.size(); }
  uint64_t reserved_memory() const override { return memory_.reserved(); }
  void Reload() override { access_.Reload(); }
  bool Stop(absl::Duration grace) override;
  bool StopCalls(absl::Duration grace) override;

 private:
  void AddMetrics();
  void AddGuardMetrics();
  absl::Status Open(grpc::ServerBuilder& builder);
  absl::Status TakeOver(grpc::ServerBuilder& builder);
  absl::Status ListenBesides();
  void Configure(grpc::ServerBuilder& builder) const;
  void Watch();
  void EndStalled();

  const ServerOptions options_;
  const int threads_;
  // oneTBB starts one worker less than this, and at most as many as both queues have places.
  const oneapi::tbb::global_control parallelism_;
  WorkQueue quick_;
  WorkLanes bulk_;
  const std::unique_ptr<DecoderPool> decoders_;
  MeshStore meshes_;
  MemoryBudget memory_;
  UnfinishedUploads uploads_;
  CallRegistry registry_;
  Access access_;
  Metrics metrics_;
  VoxelizerService service_;
  std::vector<std::string> addresses_;
  SocketFiles socket_files_;
  std::unique_ptr<grpc::Server> server_;
  SocketAcceptor acceptor_;  // destroyed before the server

  std::mutex stop_mu_;
  std::condition_variable stopped_;
  bool stopping_ = false;  // guarded by stop_mu_
  std::thread watch_;

  std::unique_ptr<HealthServer> health_server_;
  std::unique_ptr<MetricsServer> metrics_server_;  // destroyed first, because it reads the others
};

// Adds the figures that are read on request.
void Server::AddMetrics() {
  const auto add = [this](const char* name, const char* help, auto read) { metrics_.AddGauge(name, help, read); };
  add("latvox_jobs_running", "Jobs at work.", [this] { return registry_.working(); });
  add("latvox_jobs_max", "Jobs that may be at work at once.", [this] { return options_.limits.max_jobs; });
  add("latvox_jobs_queued", "Jobs that send their input or wait for their turn.",
      [this] { return registry_.queued(); });
  add("latvox_jobs_paused", "Jobs that have given up their turn until their clients take more of the results.",
      [this] { return registry_.paused(); });
  add("latvox_jobs_queued_max", "Jobs that may be queued or paused.",
      [this] { return options_.limits.max_queued_jobs; });
  add("latvox_memory_limit_bytes", "Memory that the process stays below.", [this] { return options_.memory_bytes; });
  add("latvox_memory_budget_bytes", "Memory that jobs may reserve, of that.", [this] { return memory_.total(); });
  add("latvox_memory_reserved_bytes", "Memory that jobs have reserved.", [this] { return memory_.reserved(); });
  add("latvox_unfinished_upload_bytes", "Bytes of meshes that UploadMesh has not completed yet.",
      [this] { return uploads_.bytes(); });
  add("latvox_mesh_store_bytes", "Meshes that are kept, encoded and decoded.", [this] { return meshes_.bytes(); });
  add("latvox_decoder_processes", "Processes that decode meshes.", [this] { return decoders_->facts().processes; });
  add("latvox_decoder_memory_bytes", "Memory that decoder processes hold, beyond that of this process.",
      [this] { return decoders_->facts().memory_bytes; });
  add("latvox_decoder_memory_limit_bytes", "Memory that decodes in all decoder processes may take, together.",
      [this] { return decoders_->facts().most_memory_bytes; });
  const auto count = [this](const char* name, const char* help, uint64_t DecoderFacts::*fact) {
    metrics_.AddCounter(name, help, [this, fact] { return decoders_->facts().*fact; });
  };
  count("latvox_decoder_decodes_total", "Decodes that ended, well or not.", &DecoderFacts::decodes);
  count("latvox_decoder_restarts_total", "Decoder processes that were replaced.", &DecoderFacts::restarts);
  count("latvox_decoder_crashes_total", "Decoder processes that ended by themselves while they decoded.",
        &DecoderFacts::crashes);
  count("latvox_decoder_timeouts_total", "Decodes that came to the end of their CPU time.",
        &DecoderFacts::killed_for_time);
  count("latvox_decoder_out_of_memory_total", "Decodes that came to the end of their memory.",
        &DecoderFacts::killed_for_memory);
  AddGuardMetrics();
}

void Server::AddGuardMetrics() {
  metrics_.AddGauge("latvox_connections", "Connections of clients, with those to the health port.",
                    [] { return static_cast<double>(ReadGuardFacts().connections); });
  for (int n = 0; n < kOffenses; ++n) {
    metrics_.AddCounter("latvox_connections_closed_total",
                        "Connections that were refused or closed because they attack the server.",
                        [n] { return static_cast<double>(ReadGuardFacts().closed[static_cast<size_t>(n)]); },
                        {{"offense", std::string{ToWord(static_cast<Offense>(n))}}});
  }
}

void Server::Configure(grpc::ServerBuilder& builder) const {
  builder.SetMaxReceiveMessageSize(static_cast<int>(options_.limits.received_message_bytes()));
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, ToMilliseconds(options_.keepalive_time));
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, ToMilliseconds(options_.keepalive_timeout));
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  if (options_.max_connection_age > absl::ZeroDuration()) {
    // By default, gRPC's grace for calls is endless.
    builder.AddChannelArgument(GRPC_ARG_MAX_CONNECTION_AGE_MS,
                               std::max(1, ToMilliseconds(options_.max_connection_age)));
  }
  // Clients may ping at any rate.
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 0);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_PING_STRIKES, 0);
  // Messages on their way count as well. Near the limit, gRPC reads no more, and in the end breaks streams off.
  grpc::ResourceQuota quota("latvoxd");
  quota.Resize(options_.memory_bytes / kGrpcShare);
  // Reflection keeps a thread for each call; our own calls keep none.
  quota.SetMaxThreads(kReflectionThreads);
  builder.SetResourceQuota(quota);
  WithoutCompression(builder);
  // Otherwise, a second server would share the port silently.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  // For one connection; further calls of a gRPC client wait. It bounds the cost of clients that leave calls open.
  builder.AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, static_cast<int>(kMostStreams));
  // Beyond its limit, gRPC 1.51 loses track of the client's table of fields (CVE-2023-32731). The guard has this limit,
  // too, so gRPC never sees more.
  builder.AddChannelArgument(GRPC_ARG_MAX_METADATA_SIZE, static_cast<int>(kMostHeaderBytes));
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, ToMilliseconds(kHandshakeTimeout));
}

absl::Status Server::Listen() {
  if (absl::Status status = access_.Open(ServedAddresses(options_)); !status.ok()) return status;
  if (absl::Status status = CheckAllExposed(options_); !status.ok()) return status;
  if (const std::string lack = LackOfDefense(); !lack.empty()) Log(LogLevel::kWarning, "no_guard", {{"reason", lack}});
  StartGuard(DefaultGuardLimits(threads_, MaxOpenFiles(), options_.access.behind_proxy));
  grpc::ServerBuilder builder;
  Configure(builder);
  builder.RegisterService(&service_);
  const absl::Status opened = options_.sockets.empty() ? Open(builder) : TakeOver(builder);
  if (!opened.ok()) return opened;
  if (absl::Status status = ListenBesides(); !status.ok()) return status;
  if (access_.certificate_expires()) {
    metrics_.AddGauge("latvox_tls_certificate_expiry_timestamp_seconds", "When the server's certificate ends.",
                      [this] { return absl::ToDoubleSeconds(*access_.certificate_expires() - absl::UnixEpoch()); });
  }
  access_.Follow();
  watch_ = std::thread([this] { Watch(); });
  server_->GetHealthCheckService()->SetServingStatus(v1::Voxelizer::service_full_name(), true);
  return acceptor_.Start();
}

// Opens the addresses, and starts gRPC's server.
absl::Status Server::Open(grpc::ServerBuilder& builder) {
  std::vector<int> ports(options_.listen.size(), -1);
  for (size_t n = 0; n < ports.size(); ++n) {
    const std::string& address = options_.listen[n];
    if (absl::Status status = CheckAddressIsFree(address); !status.ok()) return status;
    builder.AddListeningPort(ProvisionalAddress(address), access_.CredentialsFor(address), &ports[n]);
  }
  server_ = builder.BuildAndStart();
  if (!server_) {
    const auto failed = std::find_if(ports.begin(), ports.end(), [](int port) { return port <= 0; }) - ports.begin();
    const size_t n = std::min(static_cast<size_t>(failed), ports.size() - 1);
    return CannotListen(options_.listen[n]);
  }
  for (size_t n = 0; n < ports.size(); ++n) {
    if (absl::Status status = socket_files_.MoveIntoPlace(options_.listen[n]); !status.ok()) {
      return CannotListen(options_.listen[n], status.message());
    }
    addresses_.push_back(BoundAddress(options_.listen[n], ports[n]));
  }
  return absl::OkStatus();
}

// Starts gRPC's server with connections of sockets that are open.
absl::Status Server::TakeOver(grpc::ServerBuilder& builder) {
  if (absl::Status status = CheckTakeover(SystemCallsAreReplaced(), grpc::Version()); !status.ok()) return status;
  for (const ActivatedSocket& socket : options_.sockets) {
    acceptor_.Add(builder, socket, access_.CredentialsFor(socket.address), options_.keepalive_timeout);
    addresses_.push_back(socket.address);
  }
  server_ = builder.BuildAndStart();
  return server_ ? absl::OkStatus() : absl::UnavailableError("gRPC cannot serve the sockets of LISTEN_FDS");
}

// Listens on the addresses for metrics and health.
absl::Status Server::ListenBesides() {
  if (!options_.health_listen.empty()) {
    auto health_server = HealthServer::Start(options_.health_listen);
    if (!health_server.ok()) return health_server.status();
    health_server_ = *std::move(health_server);
    socket_files_.Add(health_server_->socket_files());
  }
  if (!options_.metrics_listen.empty()) {
    auto metrics_server = MetricsServer::Start(options_.metrics_listen, metrics_);
    if (!metrics_server.ok()) return metrics_server.status();
    metrics_server_ = *std::move(metrics_server);
  }
  return absl::OkStatus();
}

// Oversees calls at work, and ends calls of clients that no longer take part, until the server stops.
void Server::Watch() {
  constexpr auto kShortInterval = std::chrono::milliseconds(20);
  const absl::Duration interval = std::min(options_.stall_timeout / 4, absl::Seconds(1));
  absl::Time next = absl::Now() + interval;
  std::unique_lock lock(stop_mu_);
  while (!stopped_.wait_for(lock, kShortInterval, [this] { return stopping_; })) {
    lock.unlock();
    registry_.WaitForWork(interval);
    registry_.Oversee();
    if (absl::Now() >= next) {
      EndStalled();
      if (options_.alive) options_.alive();
      next = absl::Now() + interval;
    }
    lock.lock();
  }
}

// Clients that do not take their answers, or do not go on with an upload, keep memory from others no longer than the
// short patience.
void Server::EndStalled() {
  constexpr absl::Duration kShortPatience = absl::Seconds(2);
  const bool is_short = memory_.WasShort();
  registry_.EndStalled(is_short ? std::min(kShortPatience, options_.stall_timeout) : options_.stall_timeout);
  uploads_.DropIdle(is_short ? UnfinishedUploads::kShortPatience : UnfinishedUploads::kPatience);
}

bool Server::StopCalls(absl::Duration grace) {
  if (!server_) return true;
  acceptor_.Stop();
  server_->GetHealthCheckService()->Shutdown();
  if (health_server_) health_server_->SetNotServing();
  registry_.Close();
  if (registry_.WaitUntilEmpty(grace)) return true;
  registry_.StopAll();
  // grpc::Server::Shutdown never returns while a call is open, whatever its deadline. A client that does not take a
  // message cannot be told anything more.
  if (!registry_.WaitUntilEmpty(kStopTimeout / 5)) registry_.EndStalled(absl::ZeroDuration());
  return registry_.WaitUntilEmpty(kStopTimeout);
}

bool Server::Stop(absl::Duration grace) {
  if (!server_) return true;
  if (!StopCalls(grace)) return false;
  {
    const std::lock_guard lock(stop_mu_);
    stopping_ = true;
  }
  stopped_.notify_all();
  if (watch_.joinable()) watch_.join();
  server_->Shutdown(std::chrono::system_clock::now() + kCloseTimeout);
  server_.reset();
  socket_files_.Remove();
  return true;
}

}  // namespace

absl::Status VoxelServer::Check(const ServerOptions& options) {
  if (absl::Status status = CheckAddresses(options); !status.ok()) return status;
  if (absl::Status status = WithMemoryShared(options).status(); !status.ok()) return status;
  if (absl::Status status = Access(options.access).Open(ServedAddresses(options)); !status.ok()) return status;
  return CheckAllExposed(options);
}

absl::StatusOr<std::unique_ptr<VoxelServer>> VoxelServer::Start(const ServerOptions& options) {
  // The library stays up until the process ends. Its shutdown takes 10 s if a peer had stopped reading.
  static const bool kept_up = (grpc_init(), true);
  static_cast<void>(kept_up);
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  if (absl::Status status = CheckAddresses(options); !status.ok()) return status;
  const absl::StatusOr<ServerOptions> complete = WithMemoryShared(options);
  if (!complete.ok()) return complete.status();
  auto decoders = DecoderPool::Create(DecodersOf(*complete));
  if (!decoders.ok()) return decoders.status();
  auto server = std::make_unique<Server>(*complete, *std::move(decoders));
  if (absl::Status status = server->Listen(); !status.ok()) return status;
  return server;
}

}  // namespace latvox
