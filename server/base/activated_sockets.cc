#include "server/base/activated_sockets.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>
#include <optional>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "server/base/service_manager.h"

namespace latvox {
namespace {

constexpr int kFirst = 3, kMostSockets = 1000;

absl::Status Wrong(const char* name, const std::string& value, absl::string_view rule) {
  return absl::InvalidArgumentError(absl::StrCat("the environment variable ", name, " is \"", value, "\", not ", rule));
}

// Returns nothing if the kernel does not know.
std::optional<int> SocketOption(int fd, int option) {
  int value = 0;
  socklen_t size = sizeof value;
  return getsockopt(fd, SOL_SOCKET, option, &value, &size) == 0 ? std::optional(value) : std::nullopt;
}

// Returns what is wrong with a descriptor, or nothing.
std::string Fault(int fd) {
  if (fcntl(fd, F_GETFD) < 0) return "it is not open";
  const std::optional<int> type = SocketOption(fd, SO_TYPE);
  if (!type) return "it is no socket";
  if (*type != SOCK_STREAM) return "it is no stream socket: its unit needs ListenStream=";
  if (SocketOption(fd, SO_ACCEPTCONN) != 1) return "it does not listen: its unit needs Accept=no";
  return "";
}

std::string PortOf(in_port_t port) { return absl::StrCat(":", ntohs(port)); }

// Returns nothing for other networks than those of IP and Unix.
std::string AddressOf(int fd) {
  sockaddr_storage name{};
  socklen_t size = sizeof name;
  if (getsockname(fd, reinterpret_cast<sockaddr*>(&name), &size) != 0) return "";
  char host[INET6_ADDRSTRLEN];
  if (name.ss_family == AF_INET) {
    const auto& v4 = reinterpret_cast<const sockaddr_in&>(name);
    return absl::StrCat(inet_ntop(AF_INET, &v4.sin_addr, host, sizeof host), PortOf(v4.sin_port));
  }
  if (name.ss_family == AF_INET6) {
    const auto& v6 = reinterpret_cast<const sockaddr_in6&>(name);
    const std::string zone = v6.sin6_scope_id == 0 ? "" : absl::StrCat("%", v6.sin6_scope_id);
    return absl::StrCat("[", inet_ntop(AF_INET6, &v6.sin6_addr, host, sizeof host), zone, "]", PortOf(v6.sin6_port));
  }
  if (name.ss_family != AF_UNIX) return "";
  const auto& local = reinterpret_cast<const sockaddr_un&>(name);
  const size_t length = size - offsetof(sockaddr_un, sun_path);
  if (local.sun_path[0] == '\0') return absl::StrCat("unix-abstract:", std::string(local.sun_path + 1, length - 1));
  return absl::StrCat("unix:", std::string(local.sun_path, strnlen(local.sun_path, length)));
}

absl::StatusOr<ActivatedSocket> Take(int fd) {
  std::string fault = Fault(fd);
  ActivatedSocket socket = {fd, fault.empty() ? AddressOf(fd) : ""};
  if (fault.empty() && socket.address.empty()) fault = "it is neither of IP nor a Unix socket";
  if (!fault.empty()) {
    return absl::InvalidArgumentError(absl::StrCat("cannot serve file descriptor ", fd, " of LISTEN_FDS: ", fault));
  }
  // Each of several ready connections may be gone by the time it is accepted. To wait for another would block a thread.
  if (fcntl(fd, F_SETFD, FD_CLOEXEC) < 0 || fcntl(fd, F_SETFL, fcntl(fd, F_GETFL) | O_NONBLOCK) < 0) {
    return absl::InvalidArgumentError(
        absl::StrCat("cannot serve file descriptor ", fd, " of LISTEN_FDS: ", std::strerror(errno)));
  }
  return socket;
}

}  // namespace

absl::StatusOr<std::vector<ActivatedSocket>> TakeActivatedSockets() {
  const std::string process = TakeVariable("LISTEN_PID"), count = TakeVariable("LISTEN_FDS");
  TakeVariable("LISTEN_FDNAMES");
  TakeVariable("LISTEN_PIDFDID");
  std::vector<ActivatedSocket> sockets;
  if (process.empty()) return sockets;
  int64_t pid = 0;
  if (!absl::SimpleAtoi(process, &pid) || pid <= 0) return Wrong("LISTEN_PID", process, "the number of a process");
  if (pid != getpid()) return sockets;
  int fds = 0;
  if (!absl::SimpleAtoi(count, &fds) || fds < 1 || fds > kMostSockets) {
    return Wrong("LISTEN_FDS", count, absl::StrCat("a number from 1 to ", kMostSockets));
  }
  for (int fd = kFirst; fd < kFirst + fds; ++fd) {
    absl::StatusOr<ActivatedSocket> socket = Take(fd);
    if (!socket.ok()) return socket.status();
    sockets.push_back(*std::move(socket));
  }
  return sockets;
}

}  // namespace latvox
