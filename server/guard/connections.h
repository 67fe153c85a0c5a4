// The guarded connections of the process, by file descriptor and by TLS session.
#ifndef LATVOX_SERVER_GUARD_CONNECTIONS_H_
#define LATVOX_SERVER_GUARD_CONNECTIONS_H_

#include <sys/socket.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "server/guard/connection_guard.h"
#include "server/guard/frame_guard.h"
#include "server/guard/host_budgets.h"
#include "server/guard/work_budget.h"

namespace latvox {

// A stream of frames and what it may cost. Not thread-safe: gRPC reads a connection on one thread at a time.
class GuardedStream {
 public:
  GuardedStream(const GuardLimits& limits, std::shared_ptr<HostBudget> host, absl::Time now);

  // Judges the next bytes. After an offense, all further bytes are one as well.
  std::optional<Offense> Receive(absl::string_view bytes);

 private:
  FrameGuard frames_;
  WorkBudget budget_;
  const std::shared_ptr<HostBudget> host_;  // null: a Unix socket
  std::optional<Offense> offense_;
};

// A connection that gRPC has accepted. Its first byte tells whether it is plain text or TLS.
class GuardedConnection {
 public:
  GuardedConnection(const GuardLimits& limits, std::shared_ptr<HostBudget> host, const sockaddr_storage& peer,
                    absl::Time now);

  // Judges the next bytes from the network. Bytes of TLS are not judged here. gRPC ends a connection in plain text that
  // begins like TLS, by its first byte.
  std::optional<Offense> Receive(absl::string_view bytes);

  const std::shared_ptr<HostBudget>& host() const { return host_; }
  const sockaddr_storage& peer() const { return peer_; }

 private:
  enum class Kind { kUnknown, kPlain, kTls };

  Kind kind_ = Kind::kUnknown;
  GuardedStream stream_;
  const std::shared_ptr<HostBudget> host_;
  const sockaddr_storage peer_;
};

// Thread-safe, as far as gRPC uses one descriptor on one thread at a time.
class Connections {
 public:
  explicit Connections(const GuardLimits& limits);
  ~Connections();

  // Returns an offense if the new connection must be closed at once. Otherwise it is guarded until `Remove`.
  std::optional<Offense> Add(int fd, const sockaddr_storage& address);
  void Remove(int fd);

  // Returns the address that a connection was added with, also after its peer is gone.
  std::optional<sockaddr_storage> PeerOf(int fd) const;

  // Judges bytes that were read from a descriptor. Descriptors that were not added are never judged.
  std::optional<Offense> Receive(int fd, absl::string_view bytes);

  // Makes the stream inside a TLS session. The session's bytes came from the descriptor that this thread read last.
  std::unique_ptr<GuardedStream> NewTlsStream() const;

  // Counts a connection that was closed, and logs some.
  void Count(Offense offense);

  GuardFacts facts() const;

 private:
  const GuardLimits limits_;
  HostBudgets hosts_;
  std::vector<std::atomic<GuardedConnection*>> slots_;  // by descriptor
  std::atomic<size_t> count_ = 0;
  std::array<std::atomic<uint64_t>, kOffenses> closed_ = {};
  std::atomic<int64_t> logged_ = 0;  // the second of the last line in the log
};

// The connections of the process; null before StartGuard.
Connections* GuardedConnections();

// True if the functions of system_calls.cc are those that libraries call.
bool SystemCallsAreReplaced();

}  // namespace latvox

#endif  // LATVOX_SERVER_GUARD_CONNECTIONS_H_
