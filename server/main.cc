// latvoxd: the server.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "absl/time/clock.h"
#include "core/base/kept_memory.h"
#include "core/base/simd.h"
#include "deploy/process/exhaustion.h"
#include "deploy/process/orderly_end.h"
#include "server/base/activated_sockets.h"
#include "server/base/log.h"
#include "server/base/service_manager.h"
#include "server/base/signals.h"
#include "server/config/configuration_watch.h"
#include "server/config/options.h"
#include "server/decode/decoder_sandbox.h"
#include "server/decode/decoder_worker.h"
#include "server/listen/server.h"

namespace {

using latvox::Log;
using latvox::LogLevel;

constexpr int kFailed = 1;

int Fail(const absl::Status& status) {
  std::fprintf(stderr, "latvoxd: %s\n", std::string{status.message()}.c_str());
  constexpr int kWrongUsage = 2;
  return absl::IsInvalidArgument(status) ? kWrongUsage : kFailed;
}

// Longer than all steps that follow the grace period.
constexpr absl::Duration kLastResort = absl::Seconds(15);

// The exit status is 0 also if calls were abandoned: the process has ended as it was told to. After its calls, a
// private server leaves out what only ends threads and frees memory, because its client waits. Leak checks need all of
// that.
int StopServer(latvox::VoxelServer& server, const latvox::StopSignals& signals, const std::string& reason,
               absl::Duration grace, bool is_private) {
  Log(LogLevel::kInfo, "stopping",
      {{"reason", reason}, {"calls", server.calls()}, {"grace", absl::FormatDuration(grace)}});
  signals.ExitOnNext([files = server.socket_files()] { files.Remove(); });
  // Ends the process whatever gets stuck, for example if nobody reads standard error any more.
  std::thread([limit = grace + kLastResort] {
    absl::SleepFor(limit);
    std::_Exit(0);
  }).detach();
  const bool at_once = is_private && !latvox::kUnderSanitizer;
  const bool stopped = at_once ? server.StopCalls(grace) : server.Stop(grace);
  if (stopped) {
    Log(LogLevel::kInfo, "stopped", {});
  } else {
    Log(LogLevel::kWarning, "stopped", {{"abandoned_calls", server.calls()}});
  }
  if (stopped && !at_once) return 0;
  server.socket_files().Remove();
  latvox::StopLog();
  std::_Exit(0);
}

// Each connection takes one file. A login usually has 1024 files, although it may have more. The guard refuses
// connections beyond them. A private server has a handful of connections.
void RaiseFileLimit(bool is_private) {
  constexpr rlim_t kFew = 4096;
  rlimit files{};
  if (getrlimit(RLIMIT_NOFILE, &files) != 0) return;
  files.rlim_cur = files.rlim_max;
  if (setrlimit(RLIMIT_NOFILE, &files) != 0 || files.rlim_max >= kFew || is_private) return;
  Log(LogLevel::kWarning, "few_files", {{"limit", files.rlim_max}});
}

// Returns the addresses that the threads need if the system limits them: those that compute small and large jobs, and
// those of gRPC, decoders, metrics and log.
uint64_t AddressesOfThreads(int threads) {
  constexpr uint64_t kStack = uint64_t{2} << 20, kOthers = 40;
  const uint64_t computing = threads > 0 ? static_cast<uint64_t>(threads) : std::thread::hardware_concurrency();
  return (2 * computing + kOthers) * latvox::SpareStacks(kStack);
}

// What the service manager gave to this process.
struct Given {
  const latvox::ServiceManager& manager;
  std::vector<latvox::ActivatedSocket> sockets;
};

// Names each address that somebody has set, and that no socket in its place has.
void LogReplaced(const latvox::Configuration& configuration, const std::vector<std::string>& served) {
  const auto& settings = configuration.settings;
  const auto listen =
      std::find_if(settings.begin(), settings.end(), [](const auto& setting) { return setting.name == "listen"; });
  if (listen->source == "default") return;
  for (const std::string& address : configuration.options.server.listen) {
    if (std::find(served.begin(), served.end(), address) != served.end()) continue;
    Log(LogLevel::kWarning, "listen_replaced", {{"address", address}, {"by", "LISTEN_FDS"}});
  }
}

void LogAddresses(const latvox::VoxelServer& server, const std::vector<latvox::ActivatedSocket>& sockets) {
  for (size_t n = 0; n < server.addresses().size(); ++n) {
    std::vector<latvox::LogField> fields = {{"address", server.addresses()[n]}};
    if (!sockets.empty()) fields.emplace_back("fd", sockets[n].fd);
    Log(LogLevel::kInfo, "listening", fields);
  }
  for (const auto& [event, address] :
       {std::pair("health", server.health_address()), {"metrics", server.metrics_address()}}) {
    if (!address.empty()) Log(LogLevel::kInfo, event, {{"address", address}});
  }
}

int Run(const latvox::Configuration& configuration, const Given& given, int argc, char** argv, pid_t first_parent) {
  const latvox::ProgramOptions& options = configuration.options;
  // A program between this process and its parent counts as the parent. Without such a program, the parent ended before
  // this process began.
  const bool has_parent = options.parent_pid == 0 || latvox::IsAncestor(options.parent_pid);
  const pid_t parent = has_parent ? first_parent : options.parent_pid;
  const latvox::StopSignals signals(options.exit_with_parent ? std::optional(parent) : std::nullopt);
  if (const absl::Status forced = latvox::ForceSimd(options.simd); !forced.ok()) return Fail(forced);
  const absl::Status addresses = latvox::CheckAddresses(AddressesOfThreads(options.server.threads));
  if (!addresses.ok()) return Fail(addresses);
  latvox::StartLog(options.log_level, options.log_format);
  for (const auto& [name, nearest] : configuration.misspelled) {
    Log(LogLevel::kWarning, "unknown_variable", {{"name", name}, {"nearest", nearest}});
  }
  latvox::KeepHeap(latvox::kHeapOfJobs);
  // Debian's Abseil would look for cycles at each lock of gRPC.
  absl::SetMutexDeadlockDetectionMode(absl::OnDeadlockCycle::kIgnore);
  RaiseFileLimit(options.exit_with_parent);
  latvox::ConfigurationWatch watch(argc, argv, configuration);
  latvox::ServerOptions watched = options.server;
  watched.alive = [&given] { given.manager.Alive(); };
  watched.sockets = given.sockets;
  const auto server = latvox::VoxelServer::Start(watched);
  if (!server.ok()) return Fail(server.status());
  Log(LogLevel::kInfo, "started",
      {{"version", LATVOX_VERSION}, {"simd", std::string{latvox::SimdInUse()}}, {"pid", getpid()}});
  LogAddresses(**server, given.sockets);
  if (!given.sockets.empty()) LogReplaced(configuration, (*server)->addresses());
  watch.Follow();
  given.manager.Ready();
  const std::string reason = signals.Wait([&] {
    given.manager.Reloading();
    if (watch.Reload()) {
      (*server)->Reload();
      Log(LogLevel::kInfo, "reloaded", {});
    }
    given.manager.Ready();
  });
  given.manager.Stopping(options.grace + kLastResort);
  return StopServer(**server, signals, reason, options.grace, options.exit_with_parent);
}

}  // namespace

const latvox::OrderlyEnd latvox::kOrderlyEnd = {"latvoxd", kFailed};

int main(int argc, char** argv) {
  latvox::EndAsUsual();  // in a decoder process, where the sandbox forbids more
  if (const std::optional<int> status = latvox::RunIfDecoderProcess(argc, argv)) return *status;
  latvox::EndOrderlyWhenExhausted();
  latvox::SpareAddresses();
  const pid_t parent = getppid();
  const std::variant<latvox::Configuration, int> parsed = latvox::ParseOptions(argc, argv);
  if (const int* status = std::get_if<int>(&parsed)) return *status;
  const auto& configuration = std::get<latvox::Configuration>(parsed);
  if (configuration.options.check_config) {
    const absl::Status status = latvox::VoxelServer::Check(configuration.options.server);
    if (!status.ok()) return Fail(status);
    for (const auto& [name, nearest] : configuration.misspelled) {
      std::fprintf(stderr, "latvoxd: warning: the environment variable %s is no option; %s is\n", name.c_str(),
                   nearest.c_str());
    }
    std::fputs(latvox::ToToml(configuration.settings).c_str(), stdout);
    return 0;
  }
  const latvox::ServiceManager manager;
  absl::StatusOr<std::vector<latvox::ActivatedSocket>> sockets = latvox::TakeActivatedSockets();
  if (!sockets.ok()) return Fail(sockets.status());
  const int status = Run(configuration, {manager, *std::move(sockets)}, argc, argv, parent);
  latvox::StopLog();
  return status;
}
