// Budgets of connections and hosts, and the place of the guard.
#include "server/guard/connections.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/resource.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "tests/unit/server/guard/frames.h"
#include "tests/unit/server/sockets.h"

namespace latvox {
namespace {

using ::testing::HasSubstr;

constexpr GuardLimits kLimits = {
    .work_per_connection = 100'000'000, .work_per_host = 500'000'000, .connections = 100, .connections_per_host = 50};

sockaddr_storage Address(const std::string& host) {
  sockaddr_storage address{};
  auto& v4 = reinterpret_cast<sockaddr_in&>(address);
  auto& v6 = reinterpret_cast<sockaddr_in6&>(address);
  if (inet_pton(AF_INET, host.c_str(), &v4.sin_addr) == 1) {
    v4.sin_family = AF_INET;
  } else {
    v6.sin6_family = AF_INET6;
    EXPECT_EQ(inet_pton(AF_INET6, host.c_str(), &v6.sin6_addr), 1);
  }
  return address;
}

std::string Pings(int count) {
  std::string pings;
  for (int n = 0; n < count; ++n) pings += http2::Frame(http2::kPing, 0, 0, "12345678");
  return pings;
}

TEST(WorkBudget, RefillsWithTimeUpToItsMost) {
  absl::Time now = absl::UnixEpoch();
  WorkBudget budget(100, 50, now);
  EXPECT_FALSE(budget.Spend(51, now));
  EXPECT_TRUE(budget.Spend(50, now));
  EXPECT_FALSE(budget.Spend(1, now));
  EXPECT_TRUE(budget.Spend(0, now));
  EXPECT_FALSE(budget.Spend(11, now += absl::Milliseconds(105)));
  EXPECT_TRUE(budget.Spend(10, now));
  EXPECT_FALSE(budget.Full(now));
  EXPECT_TRUE(budget.Full(now += absl::Hours(1)));
  EXPECT_FALSE(budget.Spend(51, now));
}

TEST(HostKey, IsTheNetworkOfAClient) {
  EXPECT_EQ(HostKey(Address("10.0.0.1")), HostKey(Address("::ffff:10.0.0.1")));
  EXPECT_NE(HostKey(Address("10.0.0.1")), HostKey(Address("10.0.0.2")));
  EXPECT_EQ(HostKey(Address("2001:db8::1")), HostKey(Address("2001:db8::ffff:2")));
  EXPECT_NE(HostKey(Address("2001:db8::1")), HostKey(Address("2001:db8:0:1::1")));
  sockaddr_storage unix_socket{};
  unix_socket.ss_family = AF_UNIX;
  EXPECT_EQ(HostKey(unix_socket), "");
}

TEST(HostBudgets, ForgetHostsThatAreGone) {
  HostBudgets hosts(1000);
  absl::Time now = absl::UnixEpoch();
  const auto kept = hosts.Of("kept", now);
  for (int n = 0; n < 1000; ++n) hosts.Of(std::to_string(n), now += absl::Seconds(2));
  EXPECT_LT(hosts.size(), 100U);
  EXPECT_EQ(hosts.Of("kept", now), kept);
}

TEST(Connections, CloseAFloodOfOneConnection) {
  Connections connections(kLimits);
  const std::string pings = Pings(2001);  // 20 ms are allowed at once
  ASSERT_EQ(connections.Add(5, Address("10.0.0.1")), std::nullopt);
  EXPECT_EQ(connections.Receive(5, http2::Preface() + Pings(100)), std::nullopt);
  EXPECT_EQ(connections.Receive(5, pings), Offense::kFlood);
  EXPECT_EQ(connections.Receive(5, "x"), Offense::kFlood);
  EXPECT_EQ(connections.Receive(6, "never added"), std::nullopt);
}

TEST(Connections, CloseAFloodOfOneHost) {
  Connections connections(kLimits);
  const std::string pings = http2::Preface() + Pings(1900);
  std::optional<Offense> offense;
  int floods = 0;
  for (; floods < 10 && !offense; ++floods) {
    ASSERT_EQ(connections.Add(5, Address("10.0.0.1")), std::nullopt);
    offense = connections.Receive(5, pings);
    connections.Remove(5);
  }
  EXPECT_EQ(offense, Offense::kHost);
  EXPECT_GE(floods, 2);  // 31 ms are allowed at once
  ASSERT_EQ(connections.Add(5, Address("10.0.0.2")), std::nullopt);
  EXPECT_EQ(connections.Receive(5, pings), std::nullopt);
}

TEST(Connections, RefuseAHostThatComesAgainAndAgain) {
  Connections connections(kLimits);
  std::optional<Offense> offense;
  for (int n = 0; n < 100'000 && !offense; ++n) {
    offense = connections.Add(5, Address("10.0.0.1"));
    if (!offense) connections.Remove(5);
  }
  EXPECT_EQ(offense, Offense::kHost);
  EXPECT_EQ(connections.Add(5, Address("10.0.0.2")), std::nullopt);
}

TEST(Connections, HalfOfTheConnectionsAreForOthers) {
  Connections connections(kLimits);
  int admitted = 0;
  for (int fd = 0; fd < 100; ++fd) admitted += connections.Add(fd, Address("10.0.0.1")) ? 0 : 1;
  EXPECT_GE(admitted, 48);
  EXPECT_LE(admitted, 50);
  for (int fd = 100; fd < 200; ++fd) connections.Add(fd, Address("10.0.1." + std::to_string(fd)));
  EXPECT_EQ(connections.facts().connections, 100U);
  connections.Remove(0);
  EXPECT_EQ(connections.facts().connections, 99U);
}

TEST(Connections, LeaveTlsToItsSession) {
  Connections connections(kLimits);
  ASSERT_EQ(connections.Add(5, Address("10.0.0.1")), std::nullopt);
  EXPECT_EQ(connections.Receive(5, "\x16\x03\x01 no HTTP/2 here"), std::nullopt);
  EXPECT_EQ(connections.NewTlsStream()->Receive("\x16\x03\x01"), Offense::kPreface);
}

// In a process of its own, because the guard stays.
class GuardedServer {
 public:
  GuardedServer() {
    StartGuard(kLimits);
    grpc::ServerBuilder builder;
    builder.RegisterCallbackGenericService(&nothing_);
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    server_ = builder.BuildAndStart();
    reinterpret_cast<sockaddr_in&>(address_) = {.sin_family = AF_INET,
                                                .sin_port = htons(static_cast<uint16_t>(port)),
                                                .sin_addr = {htonl(INADDR_LOOPBACK)},
                                                .sin_zero = {}};
  }

  // Returns a connection that has sent `bytes`.
  int Connect(const std::string& bytes) const {
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    EXPECT_EQ(connect(fd, reinterpret_cast<const sockaddr*>(&address_), sizeof(sockaddr_in)), 0);
    EXPECT_EQ(send(fd, bytes.data(), bytes.size(), MSG_NOSIGNAL), static_cast<ssize_t>(bytes.size()));
    return fd;
  }

  // Returns whether the server sends its settings.
  static bool IsGreeted(int fd) {
    const timeval patience{10, 0};
    setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    char byte = 0;
    return recv(fd, &byte, 1, 0) == 1;
  }

 private:
  grpc::CallbackGenericService nothing_;
  std::unique_ptr<grpc::Server> server_;
  sockaddr_storage address_{};
};

TEST(Guard, StandsBeforeGrpc) {
  EXPECT_TRUE(SystemCallsAreReplaced());
  EXPECT_EQ(LackOfDefense(), "");
  const GuardedServer server;
  const int fd =
      server.Connect(http2::Preface() + http2::Call(1) + http2::Frame(http2::kHeaders, http2::kPadded, 3, "x"));
  while (GuardedServer::IsGreeted(fd)) {
  }
  close(fd);
  EXPECT_EQ(ReadGuardFacts().closed[static_cast<size_t>(Offense::kHeaderBlock)], 1U);
}

// Some versions of gRPC abort if they cannot tell who it was.
TEST(Guard, KnowsThePeerOfAConnectionThatIsReset) {
  StartGuard(kLimits);
  const Socket listener = Socket::ListeningV4();
  Socket client = listener.Connect("");
  sockaddr_in own{}, accepted{}, peer{};
  socklen_t size = sizeof own;
  ASSERT_EQ(getsockname(client.fd(), reinterpret_cast<sockaddr*>(&own), &size), 0);
  Socket::Reset(std::move(client));
  const int fd = accept4(listener.fd(), reinterpret_cast<sockaddr*>(&accepted), &size, SOCK_CLOEXEC);
  ASSERT_GE(fd, 0);
  ASSERT_EQ(getpeername(fd, reinterpret_cast<sockaddr*>(&peer), &size), 0);
  EXPECT_EQ(size, sizeof peer);
  for (const sockaddr_in& address : {accepted, peer}) {
    EXPECT_EQ(address.sin_port, own.sin_port);
    EXPECT_EQ(address.sin_addr.s_addr, own.sin_addr.s_addr);
  }
  close(fd);
  const Socket unconnected(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  EXPECT_EQ(getpeername(unconnected.fd(), reinterpret_cast<sockaddr*>(&peer), &size), -1);
  EXPECT_EQ(errno, ENOTCONN);
}

// CVE-2023-4785: gRPC stops listening for good when no file is left.
TEST(Guard, GoesOnListeningAfterFilesRanOut) {
  const GuardedServer server;
  std::vector<int> files;
  rlimit before{}, few{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  files.push_back(server.Connect(http2::Preface()));
  EXPECT_TRUE(GuardedServer::IsGreeted(files.back()));
  few = {static_cast<rlim_t>(files.back()) + 20, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &few), 0);
  while (true) {
    const int file = open("/dev/null", O_RDONLY | O_CLOEXEC);
    if (file < 0) break;
    files.push_back(file);
  }
  close(files.back());
  files.pop_back();
  const int dropped = server.Connect(http2::Preface());  // takes the last file, so the server has none for it
  EXPECT_FALSE(GuardedServer::IsGreeted(dropped));
  for (const int file : files) close(file);
  const int last = server.Connect(http2::Preface());
  EXPECT_TRUE(GuardedServer::IsGreeted(last));
  for (const int fd : {dropped, last}) close(fd);
  EXPECT_EQ(setrlimit(RLIMIT_NOFILE, &before), 0);
}

TEST(Exposure, OfAServerThatLacksDefenseNeedsAProxyOrCertificates) {
  const absl::Status refused = CheckExposed("0.0.0.0:50151", "no guard", false, false);
  EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
  for (const char* word : {"0.0.0.0:50151", "no guard", "--tls-client-ca", "--behind-proxy"}) {
    EXPECT_THAT(std::string{refused.message()}, HasSubstr(word));
  }
  EXPECT_TRUE(CheckExposed("0.0.0.0:50151", "no guard", true, false).ok());
  EXPECT_TRUE(CheckExposed("0.0.0.0:50151", "no guard", false, true).ok());
  EXPECT_TRUE(CheckExposed("127.0.0.1:50151", "no guard", false, false).ok());
  EXPECT_TRUE(CheckExposed("0.0.0.0:50151", "", false, false).ok());
}

TEST(GuardLimits, OfAHostAreAPartOfTheMachineAndAllOfItBehindAProxy) {
  constexpr Work kSecond = 1'000'000'000;
  const GuardLimits limits = DefaultGuardLimits(16, 1024, false), proxied = DefaultGuardLimits(16, 1024, true);
  EXPECT_EQ(limits.work_per_host, 2 * kSecond);
  EXPECT_EQ(proxied.work_per_host, 16 * kSecond);
  EXPECT_EQ(limits.connections_per_host, limits.connections / 2);
  EXPECT_EQ(proxied.connections_per_host, proxied.connections);
}

TEST(GrpcVersion, TakesConnectionsOverOrNot) {
  EXPECT_TRUE(CheckTakeover(false, "1.51.1").ok());
  EXPECT_TRUE(CheckTakeover(true, "1.60.0").ok());
  for (const char* aborts : {"1.52.0", "1.60.0", "2.0.0", ""}) {
    const absl::Status refused = CheckTakeover(false, aborts);
    EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument) << aborts;
    EXPECT_THAT(std::string{refused.message()}, HasSubstr("LISTEN_FDS"));
  }
}

TEST(GrpcVersion, HasTheFixOrNot) {
  for (const char* fixed : {"1.53.2", "1.54.3", "1.55.2", "1.56.0", "1.70.1", "2.0.0"})
    EXPECT_TRUE(HasFix(fixed)) << fixed;
  for (const char* open : {"1.51.1", "1.53.1", "1.54.2", "1.55.1", "1.9.0", "", "x"})
    EXPECT_FALSE(HasFix(open)) << open;
}

}  // namespace
}  // namespace latvox
