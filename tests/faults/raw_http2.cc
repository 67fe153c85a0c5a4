#include "tests/faults/raw_http2.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"

namespace latvox::faults {
namespace {

constexpr int kSendPatienceMs = 1000;

int ConnectUnix(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof(address.sun_path) - 1);
  const int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) return fd;
  close(fd);
  return -1;
}

int ConnectTcp(const std::string& host, int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<uint16_t>(port));
  if (inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1) return -1;
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0) return fd;
  close(fd);
  return -1;
}

std::string BigEndian(uint32_t value, int bytes) {
  std::string out;
  for (int n = bytes - 1; n >= 0; --n) out.push_back(static_cast<char>(value >> (8 * n)));
  return out;
}

}  // namespace

RawConnection::RawConnection(const std::string& address) {
  if (absl::StartsWith(address, "unix:")) {
    socket_ = ConnectUnix(address.substr(5));
    return;
  }
  const size_t colon = address.rfind(':');
  int port = 0;
  if (colon == std::string::npos || !absl::SimpleAtoi(address.substr(colon + 1), &port)) return;
  socket_ = ConnectTcp(address.substr(0, colon), port);
}

RawConnection::~RawConnection() {
  if (socket_ >= 0) close(socket_);
}

bool RawConnection::Send(const std::string& bytes) {
  for (size_t sent = 0; sent < bytes.size();) {
    pollfd ready{socket_, POLLOUT, 0};
    if (socket_ < 0 || poll(&ready, 1, kSendPatienceMs) <= 0) return false;
    const ssize_t n = send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (n <= 0) return false;
    sent += static_cast<size_t>(n);
  }
  return true;
}

bool RawConnection::WaitUntilClosed(absl::Duration patience) {
  const absl::Time end = absl::Now() + patience;
  for (char dropped[4096];;) {
    const int64_t left = absl::ToInt64Milliseconds(end - absl::Now());
    pollfd ready{socket_, POLLIN, 0};
    if (socket_ < 0) return true;
    if (left <= 0 || poll(&ready, 1, static_cast<int>(left)) <= 0) return false;
    if (recv(socket_, dropped, sizeof(dropped), 0) <= 0) return true;
  }
}

void RawConnection::Reset() {
  const linger none{1, 0};
  setsockopt(socket_, SOL_SOCKET, SO_LINGER, &none, sizeof(none));
  close(socket_);
  socket_ = -1;
}

std::string Preface() { return absl::StrCat("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", Frame(kSettings, 0, 0, "")); }

std::string Frame(uint8_t type, uint8_t flags, uint32_t stream, const std::string& payload) {
  return absl::StrCat(BigEndian(static_cast<uint32_t>(payload.size()), 3), BigEndian(type, 1), BigEndian(flags, 1),
                      BigEndian(stream, 4), payload);
}

std::string Header(const std::string& name, const std::string& value) {
  return absl::StrCat(BigEndian(0, 1), BigEndian(static_cast<uint32_t>(name.size()), 1), name,
                      BigEndian(static_cast<uint32_t>(value.size()), 1), value);
}

std::string CallHeaders(uint32_t stream, const std::string& method) {
  return Frame(kHeaders, kEndHeaders, stream,
               absl::StrCat(Header(":method", "POST"), Header(":scheme", "http"), Header(":path", method),
                            Header(":authority", "latvox"), Header("te", "trailers"),
                            Header("content-type", "application/grpc"), Header("grpc-timeout", "2S")));
}

std::string MessageFrame(uint32_t stream, const std::string& message, bool last) {
  const std::string prefix = BigEndian(0, 1) + BigEndian(static_cast<uint32_t>(message.size()), 4);
  return Frame(kData, last ? kEndStream : 0, stream, prefix + message);
}

}  // namespace latvox::faults
