// latvoxd: the server.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/base/simd.h"
#include "server/log.h"
#include "server/options.h"
#include "server/server.h"
#include "server/signals.h"
#include "server/unix_socket.h"

namespace {

using latvox::Log;
using latvox::LogLevel;

// Exit status 0 also if calls had to be abandoned: the process has ended as it was told to.
int StopServer(latvox::VoxelServer& server, const latvox::StopSignals& signals, const std::string& reason,
               absl::Duration grace) {
  Log(LogLevel::kInfo, "stopping",
      {{"reason", reason}, {"calls", server.calls()}, {"grace", absl::FormatDuration(grace)}});
  const std::vector<std::string> addresses = server.addresses();
  signals.ExitOnNext([addresses] { latvox::RemoveSocketFiles(addresses); });
  if (!server.Stop(grace)) {
    Log(LogLevel::kWarning, "stopped", {{"abandoned_calls", server.calls()}});
    latvox::RemoveSocketFiles(addresses);
    latvox::StopLog();
    std::_Exit(0);
  }
  Log(LogLevel::kInfo, "stopped", {});
  return 0;
}

int Run(const latvox::ProgramOptions& options, pid_t parent) {
  const latvox::StopSignals signals(options.exit_with_parent ? std::optional(parent) : std::nullopt);
  if (const absl::Status forced = latvox::ForceSimd(options.simd); !forced.ok()) {
    std::fprintf(stderr, "latvoxd: %s\n", std::string{forced.message()}.c_str());
    return 1;
  }
  latvox::StartLog(options.log_level);
  const auto server = latvox::VoxelServer::Start(options.server);
  if (!server.ok()) {
    std::fprintf(stderr, "latvoxd: %s\n", std::string{server.status().message()}.c_str());
    return 1;
  }
  Log(LogLevel::kInfo, "started",
      {{"version", LATVOX_VERSION}, {"simd", std::string{latvox::SimdInUse()}}, {"pid", getpid()}});
  for (const std::string& address : (*server)->addresses()) Log(LogLevel::kInfo, "listening", {{"address", address}});
  return StopServer(**server, signals, signals.Wait(), options.grace);
}

}  // namespace

int main(int argc, char** argv) {
  const pid_t parent = getppid();
  const std::variant<latvox::ProgramOptions, int> options = latvox::ParseOptions(argc, argv);
  if (const int* status = std::get_if<int>(&options)) return *status;
  const int status = Run(std::get<latvox::ProgramOptions>(options), parent);
  latvox::StopLog();
  return status;
}
