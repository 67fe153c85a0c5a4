// Sockets of a service manager: which are taken, and what is refused.
#include "server/base/activated_sockets.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/unit/server/sockets.h"
#include "tests/unit/temporary_directory.h"

namespace latvox {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr std::array kVariables = {"LISTEN_PID", "LISTEN_FDS", "LISTEN_FDNAMES", "LISTEN_PIDFDID"};
constexpr int kFirst = 3;

// Descriptors from 3 on, as a service manager passes them. At the end, those that were there are there again.
class Passed {
 public:
  explicit Passed(const std::vector<const Socket*>& sockets, int pid = getpid()) {
    for (const Socket* socket : sockets) {
      const int at = kFirst + static_cast<int>(before_.size());
      before_.push_back(fcntl(at, F_DUPFD_CLOEXEC, Socket::kLowest));
      dup2(socket->fd(), at);
    }
    setenv("LISTEN_PID", std::to_string(pid).c_str(), 1);
    setenv("LISTEN_FDS", std::to_string(sockets.size()).c_str(), 1);
    setenv("LISTEN_FDNAMES", "names:of:them", 1);
    setenv("LISTEN_PIDFDID", "7", 1);
  }
  ~Passed() {
    for (size_t n = 0; n < before_.size(); ++n) {
      const int at = kFirst + static_cast<int>(n);
      close(at);
      if (before_[n] < 0) continue;
      dup2(before_[n], at);
      close(before_[n]);
    }
    for (const char* variable : kVariables) unsetenv(variable);
  }
  Passed(const Passed&) = delete;
  Passed& operator=(const Passed&) = delete;

 private:
  std::vector<int> before_;
};

void ExpectNoVariable() {
  for (const char* variable : kVariables) EXPECT_EQ(std::getenv(variable), nullptr) << variable;
}

TEST(ActivatedSockets, AreTakenWithTheirAddresses) {
  const TemporaryDirectory directory;
  const Socket v4 = Socket::ListeningV4(), local = Socket::ListeningAt(directory / "socket"),
               abstract = Socket::ListeningAt(std::string(1, '\0') + directory.path());
  const Passed passed({&v4, &local, &abstract});
  const auto sockets = TakeActivatedSockets();
  ASSERT_TRUE(sockets.ok()) << sockets.status();
  ASSERT_EQ(sockets->size(), 3U);
  EXPECT_THAT((*sockets)[0].address, StartsWith("127.0.0.1:"));
  EXPECT_EQ((*sockets)[0].address, "127.0.0.1:" + std::to_string(v4.Port()));
  EXPECT_EQ((*sockets)[1].address, "unix:" + directory / "socket");
  EXPECT_EQ((*sockets)[2].address, "unix-abstract:" + directory.path());
  for (int n = 0; n < 3; ++n) {
    EXPECT_EQ((*sockets)[static_cast<size_t>(n)].fd, kFirst + n);
    EXPECT_NE(fcntl(kFirst + n, F_GETFD) & FD_CLOEXEC, 0);
    EXPECT_NE(fcntl(kFirst + n, F_GETFL) & O_NONBLOCK, 0);
  }
  ExpectNoVariable();
}

TEST(ActivatedSockets, HaveAddressesOfIpV6InBrackets) {
  const Socket v6 = Socket::ListeningV6();
  if (v6.fd() < 0) GTEST_SKIP() << "this machine has no ::1";
  const Passed passed({&v6});
  const auto sockets = TakeActivatedSockets();
  ASSERT_TRUE(sockets.ok()) << sockets.status();
  EXPECT_EQ(sockets->at(0).address, "[::1]:" + std::to_string(v6.Port()));
}

TEST(ActivatedSockets, OfAnotherProcessAreLeftAlone) {
  const Socket v4 = Socket::ListeningV4();
  const Passed passed({&v4}, getpid() + 1);
  const auto sockets = TakeActivatedSockets();
  ASSERT_TRUE(sockets.ok()) << sockets.status();
  EXPECT_TRUE(sockets->empty());
  EXPECT_EQ(fcntl(kFirst, F_GETFD) & FD_CLOEXEC, 0);
  ExpectNoVariable();
}

TEST(ActivatedSockets, NeedVariables) {
  const auto sockets = TakeActivatedSockets();
  ASSERT_TRUE(sockets.ok()) << sockets.status();
  EXPECT_TRUE(sockets->empty());
}

TEST(ActivatedSockets, WithWrongVariablesAreRefused) {
  const std::string own = std::to_string(getpid());
  for (const auto& [pid, fds, message] :
       std::vector<std::array<std::string, 3>>{{"me", "1", "LISTEN_PID is \"me\", not the number of a process"},
                                               {"-1", "1", "LISTEN_PID is \"-1\", not the number of a process"},
                                               {own, "", "LISTEN_FDS is \"\", not a number from 1 to 1000"},
                                               {own, "0", "LISTEN_FDS is \"0\", not a number from 1 to 1000"},
                                               {own, "1001", "LISTEN_FDS is \"1001\", not a number from 1 to 1000"},
                                               {own, "one", "LISTEN_FDS is \"one\", not a number from 1 to 1000"}}) {
    setenv("LISTEN_PID", pid.c_str(), 1);
    setenv("LISTEN_FDS", fds.c_str(), 1);
    const absl::Status refused = TakeActivatedSockets().status();
    EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_EQ(refused.message(), "the environment variable " + message);
    ExpectNoVariable();
  }
}

TEST(ActivatedSockets, ThatDoNotListenForStreamsAreRefused) {
  const Socket good = Socket::ListeningV4(), silent(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)),
               datagrams(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)), file(open("/dev/null", O_RDONLY | O_CLOEXEC)),
               packets = Socket::ListeningForPackets(), none(-1);
  for (const auto& [socket, fault] : std::vector<std::pair<const Socket*, std::string>>{
           {&silent, "it does not listen: its unit needs Accept=no"},
           {&datagrams, "it is no stream socket: its unit needs ListenStream="},
           {&packets, "it is no stream socket: its unit needs ListenStream="},
           {&file, "it is no socket"}}) {
    const Passed passed({&good, socket});
    const absl::Status refused = TakeActivatedSockets().status();
    EXPECT_EQ(refused.code(), absl::StatusCode::kInvalidArgument);
    EXPECT_EQ(refused.message(), "cannot serve file descriptor 4 of LISTEN_FDS: " + fault);
  }
  const Passed passed({&good, &good});
  close(kFirst + 1);
  EXPECT_THAT(std::string{TakeActivatedSockets().status().message()},
              HasSubstr("descriptor 4 of LISTEN_FDS: it is not open"));
}

}  // namespace
}  // namespace latvox
