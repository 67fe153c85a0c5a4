#include "server/listen/socket_acceptor.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "server/base/log.h"

namespace latvox {
namespace {

// After a failure. A connection that cannot be accepted stays ready, and would keep the thread busy.
constexpr int kPauseMs = 10;
constexpr absl::Duration kBetweenLines = absl::Seconds(1);

// Accepted sockets inherit these options, which gRPC sets at its own ports. A Unix socket has none of them.
void SetOptionsOfConnections(int listener, absl::Duration acknowledge_timeout) {
  const int at_once = 1, milliseconds = static_cast<int>(absl::ToInt64Milliseconds(acknowledge_timeout));
  setsockopt(listener, IPPROTO_TCP, TCP_NODELAY, &at_once, sizeof at_once);
  setsockopt(listener, IPPROTO_TCP, TCP_USER_TIMEOUT, &milliseconds, sizeof milliseconds);
}

}  // namespace

void SocketAcceptor::Add(grpc::ServerBuilder& builder, const ActivatedSocket& socket,
                         std::shared_ptr<grpc::ServerCredentials> credentials, absl::Duration acknowledge_timeout) {
  SetOptionsOfConnections(socket.fd, acknowledge_timeout);
  using Builder = grpc::ServerBuilder::experimental_type;
  listeners_.push_back({socket, builder.experimental().AddExternalConnectionAcceptor(
                                    Builder::ExternalConnectionType::FROM_FD, std::move(credentials))});
}

absl::Status SocketAcceptor::Start() {
  if (listeners_.empty()) return absl::OkStatus();
  stop_ = eventfd(0, EFD_CLOEXEC);
  if (stop_ < 0) {
    return absl::UnavailableError(absl::StrCat("cannot serve the sockets of LISTEN_FDS: ", std::strerror(errno)));
  }
  thread_ = std::thread([this] { Run(); });
  return absl::OkStatus();
}

void SocketAcceptor::Stop() {
  if (!thread_.joinable()) return;
  eventfd_write(stop_, 1);
  thread_.join();
  close(stop_);
}

void SocketAcceptor::Run() {
  std::vector<pollfd> polled = {{stop_, POLLIN, 0}};
  for (const Listener& listener : listeners_) polled.push_back({listener.socket.fd, POLLIN, 0});
  while (true) {
    const bool polls = poll(polled.data(), polled.size(), -1) > 0;
    if (polls && polled[0].revents != 0) return;
    bool fails = !polls;
    // One of each, so that no socket and no Stop waits for the connections, or the failures, of another.
    for (size_t n = 0; n < listeners_.size() && polls; ++n) {
      if (polled[n + 1].revents != 0 && !AcceptOne(listeners_[n])) fails = true;
    }
    if (fails) poll(polled.data(), 1, kPauseMs);
  }
}

bool SocketAcceptor::AcceptOne(const Listener& listener) {
  grpc::experimental::ExternalConnectionAcceptor::NewConnectionParameters connection;
  connection.listener_fd = listener.socket.fd;
  connection.fd = accept4(listener.socket.fd, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (connection.fd < 0) {
    LogFailure(listener, errno);
    return false;
  }
  listener.connections->HandleNewConnection(&connection);
  return true;
}

void SocketAcceptor::LogFailure(const Listener& listener, int error) {
  const bool is_usual = error == EAGAIN || error == EINTR || error == ECONNABORTED;  // the client has gone
  const absl::Time now = absl::Now();
  if (is_usual || now < next_line_) return;
  next_line_ = now + kBetweenLines;
  Log(LogLevel::kWarning, "accept_failed", {{"address", listener.socket.address}, {"error", std::strerror(error)}});
}

}  // namespace latvox
