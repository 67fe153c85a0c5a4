#include "server/guard/connection_guard.h"

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <atomic>
#include <cstdio>

#include "absl/strings/str_cat.h"
#include "server/base/endpoint.h"
#include "server/guard/connections.h"

namespace latvox {
namespace {

// Nanoseconds of a core in a second. A connection may cause a tenth of a core, a host an eighth of the machine.
constexpr Work kSecond = 1'000'000'000;
constexpr Work kConnectionsOfACore = 10, kHostsOfAMachine = 8;

// Files for the other needs of the process, and more connections than any machine serves.
constexpr double kOtherFiles = 256, kMostConnections = 50'000;

std::atomic<Connections*> guarded = nullptr;

struct GrpcVersion {
  int major = 0, minor = 0, patch = 0;
};

// Returns zeros if the text is no version.
GrpcVersion Parse(const std::string& text) {
  GrpcVersion version;
  const int parts = std::sscanf(text.c_str(), "%d.%d.%d", &version.major, &version.minor, &version.patch);
  return parts == 3 ? version : GrpcVersion{};
}

}  // namespace

GuardLimits DefaultGuardLimits(int cores, double files, bool behind_proxy) {
  const double others = std::min(kOtherFiles, files / 2);
  const auto connections = static_cast<size_t>(std::min(files - others, kMostConnections));
  return {.work_per_connection = kSecond / kConnectionsOfACore,
          .work_per_host = kSecond * cores / (behind_proxy ? 1 : kHostsOfAMachine),
          .connections = connections,
          .connections_per_host = behind_proxy ? connections : connections / 2};
}

void StartGuard(const GuardLimits& limits) {
  static Connections* const started = new Connections(limits);  // gRPC's threads use it to the end of the process
  guarded = started;
}

Connections* GuardedConnections() { return guarded.load(std::memory_order_acquire); }

GuardFacts ReadGuardFacts() {
  const Connections* const started = GuardedConnections();
  return started == nullptr ? GuardFacts{} : started->facts();
}

// gRPC 1.53.2, 1.54.3 and 1.55.2 have the fix as well, and so have all later versions.
bool HasFix(const std::string& version) {
  const auto [major, minor, patch] = Parse(version);
  if (major != 1) return major > 1;
  switch (minor) {
    case 53:
    case 55:
      return patch >= 2;
    case 54:
      return patch >= 3;
    default:
      return minor > 55;
  }
}

// gRPC 1.51 closes such a connection. Later versions may accept by their EventEngine, which aborts.
absl::Status CheckTakeover(bool is_guarded, const std::string& version) {
  constexpr int kLastThatCloses = 51;
  const auto [major, minor, patch] = Parse(version);
  if (is_guarded || (major == 1 && minor <= kLastThatCloses)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "cannot serve the sockets of LISTEN_FDS: gRPC ", version,
      " aborts at a connection that is reset before it takes it over, and this build has no guard against that"));
}

std::string LackOfDefense() {
  if (SystemCallsAreReplaced() || HasFix(grpc::Version())) return "";
  return absl::StrCat(
      "gRPC ", grpc::Version(),
      " parses an unfinished header again with each frame (CVE-2023-33953), and this build has no guard");
}

absl::Status CheckExposed(const std::string& address, const std::string& lack, bool behind_proxy, bool mutual_tls) {
  if (lack.empty() || behind_proxy || mutual_tls || IsLocal(address)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      "refusing to listen on ", address, ", because one connection can stop this server: ", lack,
      "; give --tls-client-ca, so that only clients with a certificate can, or --behind-proxy, if others reach the "
      "address only through a proxy that closes such connections, such as haproxy"));
}

}  // namespace latvox
