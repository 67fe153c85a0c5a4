// Functions of the C library and of OpenSSL, replaced for this process. The dynamic linker looks a symbol up in the
// program before it looks in libraries, so gRPC calls these functions. They call the originals.
#include <dlfcn.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <optional>
#include <string>

#include "server/guard/connections.h"

namespace latvox {
namespace {

#ifdef LATVOX_GUARD

// Returns the function that this program replaces. In a build with a sanitizer that is the sanitizer's own, so that it
// knows which descriptors are closed, and used again.
template <class Function>
Function* Original(const char* name) {
  void* const sanitized = dlsym(RTLD_DEFAULT, (std::string("__interceptor_") + name).c_str());
  return reinterpret_cast<Function*>(sanitized != nullptr ? sanitized : dlsym(RTLD_NEXT, name));
}

// Returns whether a library that calls `name` calls `ours`.
template <class Function>
bool IsReplaced(const char* name, Function* ours) {
  return dlsym(RTLD_DEFAULT, name) == reinterpret_cast<void*>(ours);
}

using AcceptFunction = int(int, sockaddr*, socklen_t*, int);
using PeerFunction = int(int, sockaddr*, socklen_t*);
using ReceiveFunction = ssize_t(int, msghdr*, int);
using CloseFunction = int(int);
using SslReadFunction = int(SSL*, void*, int);

int Close(int fd) {
  static CloseFunction* const original = Original<CloseFunction>("close");
  return original(fd);
}

// A child process that shares this one's memory closes its own descriptors, not ours.
bool IsOurProcess() {
  static const pid_t pid = getpid();
  return getpid() == pid;
}

// Writes a name as accept4 and getpeername do.
void GiveName(const sockaddr_storage& name, socklen_t length, sockaddr* address, socklen_t* size) {
  std::memcpy(address, &name, std::min(*size, length));
  *size = length;
}

// Accepts without gRPC. gRPC stops listening for good if accept4 fails, except for a few errors (CVE-2023-4785).
class Acceptor {
 public:
  Acceptor() : spare_(OpenSpare()) {}

  // Returns the next connection that the guard admits, or -1 with an error after which gRPC goes on listening.
  int Accept(Connections& connections, int listener, sockaddr* address, socklen_t* size, int flags) {
    for (;;) {
      // A peer that has gone away by now has no name any more, but accept4 still tells it.
      sockaddr_storage peer{};
      socklen_t peer_size = sizeof peer;
      const int fd = Original(listener, reinterpret_cast<sockaddr*>(&peer), &peer_size, flags);
      if (fd < 0) {
        if (errno == EMFILE || errno == ENFILE) {
          if (DropOne(listener)) continue;
          errno = EAGAIN;
        }
        if (IsOfOneConnection(errno)) continue;
        return fd;
      }
      const std::optional<Offense> offense = connections.Add(fd, peer);
      if (!offense) {
        if (address != nullptr && size != nullptr) GiveName(peer, peer_size, address, size);
        return fd;
      }
      connections.Count(*offense);
      Close(fd);
    }
  }

  static int Original(int listener, sockaddr* address, socklen_t* size, int flags) {
    static AcceptFunction* const original = latvox::Original<AcceptFunction>("accept4");
    return original(listener, address, size, flags);
  }

 private:
  static int OpenSpare() { return open("/dev/null", O_RDONLY | O_CLOEXEC); }

  // Linux reports errors of the network that are about a waiting connection, not about the listener.
  static bool IsOfOneConnection(int error) {
    return error == ENETDOWN || error == EPROTO || error == ENOPROTOOPT || error == EHOSTDOWN || error == ENONET ||
           error == EHOSTUNREACH || error == EOPNOTSUPP || error == ENETUNREACH || error == EPERM;
  }

  // Closes one waiting connection, by the file that is kept for it. Otherwise it would wait, and no further connection
  // would tell gRPC to look again.
  bool DropOne(int listener) {
    const int spare = spare_.exchange(-1);
    if (spare < 0) return false;
    Close(spare);
    const int fd = Original(listener, nullptr, nullptr, SOCK_CLOEXEC);
    if (fd >= 0) Close(fd);
    spare_ = OpenSpare();
    return fd >= 0;
  }

  std::atomic<int> spare_;
};

int Accept(int listener, sockaddr* address, socklen_t* size, int flags) {
  Connections* const connections = GuardedConnections();
  if (connections == nullptr) return Acceptor::Original(listener, address, size, flags);
  static Acceptor& acceptor = *new Acceptor;
  return acceptor.Accept(*connections, listener, address, size, flags);
}

socklen_t SizeOfName(sa_family_t family) {
  return family == AF_INET ? sizeof(sockaddr_in) : family == AF_INET6 ? sizeof(sockaddr_in6) : 0;
}

// Some versions of gRPC abort, or stop listening, if a new connection has no peer any more. With a name they go on, and
// find the connection's end as they read.
int PeerName(int fd, sockaddr* address, socklen_t* size) {
  static PeerFunction* const original = Original<PeerFunction>("getpeername");
  const int result = original(fd, address, size);
  Connections* const connections = GuardedConnections();
  if (result == 0 || errno != ENOTCONN || connections == nullptr) return result;
  const std::optional<sockaddr_storage> peer = connections->PeerOf(fd);
  const socklen_t length = peer ? SizeOfName(peer->ss_family) : 0;
  if (length == 0) return result;
  GiveName(*peer, length, address, size);
  return 0;
}

// Returns the first offense in the bytes that a call has received.
std::optional<Offense> Judge(Connections& connections, int fd, const msghdr& message, size_t count) {
  for (size_t n = 0; n < message.msg_iovlen && count > 0; ++n) {
    const size_t size = std::min(count, message.msg_iov[n].iov_len);
    if (auto offense = connections.Receive(fd, {static_cast<const char*>(message.msg_iov[n].iov_base), size})) {
      return offense;
    }
    count -= size;
  }
  return std::nullopt;
}

ssize_t Receive(int fd, msghdr* message, int flags) {
  static ReceiveFunction* const original = Original<ReceiveFunction>("recvmsg");
  const ssize_t count = original(fd, message, flags);
  Connections* const connections = GuardedConnections();
  if (count <= 0 || connections == nullptr || (flags & MSG_ERRQUEUE) != 0) return count;
  const std::optional<Offense> offense = Judge(*connections, fd, *message, static_cast<size_t>(count));
  if (!offense) return count;
  connections->Count(*offense);
  shutdown(fd, SHUT_RDWR);  // further calls return 0
  errno = ECONNRESET;
  return -1;
}

// The stream of a TLS session, which the session owns.
int TlsStreamIndex() {
  static const int index = SSL_get_ex_new_index(
      0, nullptr, nullptr, nullptr,
      [](void*, void* stream, CRYPTO_EX_DATA*, int, long, void*) { delete static_cast<GuardedStream*>(stream); });
  return index;
}

int SslRead(SSL* session, void* buffer, int size) {
  static SslReadFunction* const original = Original<SslReadFunction>("SSL_read");
  const int count = original(session, buffer, size);
  Connections* const connections = GuardedConnections();
  if (count <= 0 || connections == nullptr || SSL_is_server(session) == 0) return count;
  auto* stream = static_cast<GuardedStream*>(SSL_get_ex_data(session, TlsStreamIndex()));
  if (stream == nullptr) {
    stream = connections->NewTlsStream().release();
    SSL_set_ex_data(session, TlsStreamIndex(), stream);
  }
  const auto offense = stream->Receive({static_cast<const char*>(buffer), static_cast<size_t>(count)});
  if (!offense) return count;
  connections->Count(*offense);
  ERR_raise(ERR_LIB_USER, ERR_R_INTERNAL_ERROR);  // SSL_get_error then tells gRPC that the session is broken
  return -1;
}

#endif  // LATVOX_GUARD

}  // namespace
}  // namespace latvox

#ifdef LATVOX_GUARD

extern "C" {

int accept4(int fd, sockaddr* addr, socklen_t* addr_len, int flags) {
  return latvox::Accept(fd, addr, addr_len, flags);
}

int getpeername(int fd, sockaddr* addr, socklen_t* len) noexcept { return latvox::PeerName(fd, addr, len); }

ssize_t recvmsg(int fd, msghdr* message, int flags) { return latvox::Receive(fd, message, flags); }

int close(int fd) {
  latvox::Connections* const connections = latvox::GuardedConnections();
  if (connections != nullptr && latvox::IsOurProcess()) connections->Remove(fd);
  return latvox::Close(fd);
}

int SSL_read(SSL* ssl, void* buf, int num) { return latvox::SslRead(ssl, buf, num); }

}  // extern "C"

namespace latvox {

bool SystemCallsAreReplaced() {
  return IsReplaced("accept4", &accept4) && IsReplaced("getpeername", &getpeername) &&
         IsReplaced("recvmsg", &recvmsg) && IsReplaced("close", &close) && IsReplaced("SSL_read", &SSL_read);
}

}  // namespace latvox

#else

namespace latvox {

bool SystemCallsAreReplaced() { return false; }

}  // namespace latvox

#endif  // LATVOX_GUARD
