// Sockets by hand, for tests.
#ifndef LATVOX_TESTS_UNIT_SERVER_SOCKETS_H_
#define LATVOX_TESTS_UNIT_SERVER_SOCKETS_H_

#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <string>
#include <utility>

namespace latvox {

// A descriptor that it closes, above those that a service manager passes. Below 0: there is none.
class Socket {
 public:
  static constexpr int kLowest = 50;

  explicit Socket(int fd) : fd_(fd < 0 ? fd : fcntl(fd, F_DUPFD_CLOEXEC, kLowest)) {
    if (fd >= 0) close(fd);
  }
  Socket(Socket&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  ~Socket() {
    if (fd_ >= 0) close(fd_);
  }

  // At a free port of 127.0.0.1 or ::1.
  static Socket ListeningV4() {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return Listening(SOCK_STREAM, address, sizeof address);
  }
  static Socket ListeningV6() {
    sockaddr_in6 address{};
    address.sin6_family = AF_INET6;
    address.sin6_addr = in6addr_loopback;
    return Listening(SOCK_STREAM, address, sizeof address);
  }

  // At a path, or at an abstract name behind a zero.
  static Socket ListeningAt(const std::string& path) { return ListeningLocally(SOCK_STREAM, path); }
  static Socket ListeningForPackets() { return ListeningLocally(SOCK_SEQPACKET, ""); }

  // Returns a connection that has sent `bytes` to whoever listens at the socket.
  Socket Connect(const std::string& bytes) const {
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    EXPECT_EQ(getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    Socket connection(socket(address.ss_family, SOCK_STREAM | SOCK_CLOEXEC, 0));
    EXPECT_EQ(connect(connection.fd_, reinterpret_cast<const sockaddr*>(&address), size), 0);
    EXPECT_EQ(send(connection.fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
    return connection;
  }

  // Returns whether another byte comes.
  bool IsGreeted() const {
    const timeval patience{20, 0};
    setsockopt(fd_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    char byte = 0;
    return recv(fd_, &byte, 1, 0) == 1;
  }

  // Ends a connection as if its host had crashed and come back.
  static void Reset(Socket connection) {
    const linger at_once{1, 0};
    setsockopt(connection.fd_, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  }

  int fd() const { return fd_; }
  int Port() const {
    sockaddr_in6 address{};  // its port is where that of IPv4 is
    socklen_t size = sizeof address;
    getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &size);
    return ntohs(address.sin6_port);
  }

 private:
  template <class Address>
  static Socket Listening(int type, const Address& address, size_t size) {
    const auto* name = reinterpret_cast<const sockaddr*>(&address);
    Socket listener(socket(name->sa_family, type | SOCK_CLOEXEC, 0));
    const bool listens =
        bind(listener.fd_, name, static_cast<socklen_t>(size)) == 0 && listen(listener.fd_, SOMAXCONN) == 0;
    return listens ? std::move(listener) : Socket(-1);
  }
  static Socket ListeningLocally(int type, const std::string& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, sizeof address.sun_path);
    return Listening(type, address, offsetof(sockaddr_un, sun_path) + path.size());
  }

  int fd_;
};

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_SERVER_SOCKETS_H_
