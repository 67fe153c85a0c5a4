#include "tests/unit/client/relay.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>

namespace latvox::client {
namespace {

sockaddr_in Loopback(int port) {
  sockaddr_in name{};
  name.sin_family = AF_INET;
  name.sin_port = htons(static_cast<uint16_t>(port));
  name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  return name;
}

}  // namespace

Relay::Relay(const std::string& server) : server_port_(std::stoi(server.substr(server.rfind(':') + 1))) {
  listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in name = Loopback(0);
  socklen_t size = sizeof(name);
  bind(listener_, reinterpret_cast<sockaddr*>(&name), size);
  listen(listener_, 16);
  getsockname(listener_, reinterpret_cast<sockaddr*>(&name), &size);
  address_ = "127.0.0.1:" + std::to_string(ntohs(name.sin_port));
  thread_ = std::thread([this] { Run(); });
}

Relay::~Relay() {
  stop_ = true;
  thread_.join();
  std::for_each(pairs_.begin(), pairs_.end(), Reset);
  close(listener_);
}

void Relay::Run() {
  while (!stop_) {
    std::vector<pollfd> sources = {{listener_, POLLIN, 0}};
    for (const Pair& pair : pairs_) {
      for (const int fd : {pair.client, pair.server}) sources.push_back({pair.frozen ? -1 : fd, POLLIN, 0});
    }
    poll(sources.data(), sources.size(), /*timeout=*/2);
    Obey();
    for (size_t n = std::min(pairs_.size(), sources.size() / 2); n-- > 0;) {
      const Pair pair = pairs_[n];
      if (pair.frozen) continue;
      const bool open = (sources[2 * n + 1].revents == 0 || Pass(pair.client, pair.server)) &&
                        (sources[2 * n + 2].revents == 0 || Pass(pair.server, pair.client));
      if (open) continue;
      Reset(pair);
      pairs_.erase(pairs_.begin() + static_cast<ptrdiff_t>(n));
    }
    if (sources[0].revents != 0) Accept();
  }
}

void Relay::Accept() {
  const int client = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
  const int server = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const sockaddr_in name = Loopback(server_port_);
  const Pair pair{client, server};
  if (connect(server, reinterpret_cast<const sockaddr*>(&name), sizeof(name)) == 0) {
    pairs_.push_back(pair);
  } else {
    Reset(pair);
  }
}

void Relay::Obey() {
  if (freeze_.exchange(false)) {
    for (Pair& pair : pairs_) pair.frozen = true;
  }
  if (!cut_.exchange(false)) return;
  std::for_each(pairs_.begin(), pairs_.end(), Reset);
  pairs_.clear();
}

bool Relay::Pass(int from, int to) {
  char bytes[1 << 16];
  const ssize_t got = read(from, bytes, sizeof(bytes));
  return got > 0 && send(to, bytes, static_cast<size_t>(got), MSG_NOSIGNAL) == got;
}

// With lingering off, close sends a reset.
void Relay::Reset(const Pair& pair) {
  for (const int fd : {pair.client, pair.server}) {
    const linger none{1, 0};
    setsockopt(fd, SOL_SOCKET, SO_LINGER, &none, sizeof(none));
    close(fd);
  }
}

}  // namespace latvox::client
