// The guard before gRPC's connections: it reads what gRPC is about to read, and ends connections that attack the
// server.
//
// gRPC offers no place for it. So this program replaces five functions of the system's libraries that gRPC calls:
// accept4, getpeername, recvmsg, close, and SSL_read of OpenSSL; see system_calls.cc. The decision is in
// tests/notes/2026-11-guard.md.
#ifndef LATVOX_SERVER_GUARD_CONNECTION_GUARD_H_
#define LATVOX_SERVER_GUARD_CONNECTION_GUARD_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

#include "absl/status/status.h"
#include "server/guard/frame_guard.h"
#include "server/guard/work_budget.h"

namespace latvox {

struct GuardLimits {
  Work work_per_connection = 0, work_per_host = 0;  // in a second
  size_t connections = 0, connections_per_host = 0;
};

// Returns the limits for a machine with so many cores, and a process that may open so many files. Behind a proxy, which
// limits each client by itself, one host sends the calls of everybody. So it may have all connections, and cause the
// work of the whole machine.
GuardLimits DefaultGuardLimits(int cores, double files, bool behind_proxy);

// Guards connections that are accepted from now on, until the process ends. Further calls change nothing. Thread-safe.
void StartGuard(const GuardLimits& limits);

// Connections that the guard refused or closed, and those that it watches.
struct GuardFacts {
  std::array<uint64_t, kOffenses> closed = {};  // by Offense
  size_t connections = 0;
};
GuardFacts ReadGuardFacts();

// Returns whether this version of gRPC has the fix of CVE-2023-33953, and needs no guard against it.
bool HasFix(const std::string& version);

// Returns INVALID_ARGUMENT if a client could end the process by a connection that it resets before this version of gRPC
// takes it over from a socket of a service manager. `is_guarded`: the guard is in effect, and prevents that.
absl::Status CheckTakeover(bool is_guarded, const std::string& version);

// Returns why an anonymous connection can stop this process, or nothing if the guard or gRPC's fix is in effect.
std::string LackOfDefense();

// Returns INVALID_ARGUMENT, naming address and options, unless nothing is lacking (`lack` is empty), the address is
// local, a proxy protects it (`behind_proxy`), or clients show certificates before they can send a frame
// (`mutual_tls`).
absl::Status CheckExposed(const std::string& address, const std::string& lack, bool behind_proxy, bool mutual_tls);

}  // namespace latvox

#endif  // LATVOX_SERVER_GUARD_CONNECTION_GUARD_H_
