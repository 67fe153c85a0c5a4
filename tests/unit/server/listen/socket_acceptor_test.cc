// A server of sockets that were open before it began.
#include "server/listen/socket_acceptor.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/tcp.h>
#include <sys/stat.h>

#include <memory>
#include <string>
#include <vector>

#include "server/guard/connection_guard.h"
#include "tests/unit/server/calls.h"
#include "tests/unit/server/guard/frames.h"
#include "tests/unit/server/sockets.h"

namespace latvox {
namespace {

// Bytes that the guard ends a connection for: the length of the padding is beyond the frame.
std::string Attack() { return http2::Preface() + http2::Frame(http2::kHeaders, http2::kPadded, 1, "x"); }

class SocketAcceptorTest : public ServerTest {
 protected:
  SocketAcceptorTest() {
    options_.sockets = {{v4_.fd(), "127.0.0.1:" + std::to_string(v4_.Port())}, {local_.fd(), "unix:" + path_}};
    for (const Socket* socket : {&v4_, &local_}) fcntl(socket->fd(), F_SETFL, O_NONBLOCK);
  }

  static uint64_t ClosedForHeaders() { return ReadGuardFacts().closed[static_cast<size_t>(Offense::kHeaderBlock)]; }

  const std::string path_ = directory_ / "passed";
  const Socket v4_ = Socket::ListeningV4(), local_ = Socket::ListeningAt(path_);
};

TEST_F(SocketAcceptorTest, ServesTheSocketsInPlaceOfItsAddresses) {
  Start();
  EXPECT_EQ(server_->addresses(), (std::vector{options_.sockets[0].address, options_.sockets[1].address}));
  for (const std::string& address : server_->addresses()) {
    const auto stub = v1::Voxelizer::NewStub(grpc::CreateChannel(address, grpc::InsecureChannelCredentials()));
    const Answer answer = Voxelize(*stub, Spec(20), SphereBytes());
    EXPECT_TRUE(answer.status.ok()) << address << ": " << answer.status.error_message();
  }
  struct stat file {};
  EXPECT_NE(lstat((directory_ / "socket").c_str(), &file), 0) << "it listens at its address, too";
  EXPECT_TRUE(server_->Stop(absl::ZeroDuration()));
  EXPECT_EQ(lstat(path_.c_str(), &file), 0) << "it removes the file of another";
}

TEST_F(SocketAcceptorTest, GivesConnectionsTheOptionsOfGrpc) {
  Start();
  int at_once = 0, milliseconds = 0;
  socklen_t size = sizeof at_once;
  ASSERT_EQ(getsockopt(v4_.fd(), IPPROTO_TCP, TCP_NODELAY, &at_once, &size), 0);
  ASSERT_EQ(getsockopt(v4_.fd(), IPPROTO_TCP, TCP_USER_TIMEOUT, &milliseconds, &size), 0);
  EXPECT_NE(at_once, 0);
  EXPECT_EQ(milliseconds, absl::ToInt64Milliseconds(options_.keepalive_timeout));
}

TEST_F(SocketAcceptorTest, ItsConnectionsAreGuarded) {
  Start();
  for (const Socket* listener : {&v4_, &local_}) {
    ASSERT_TRUE(Eventually([] { return ReadGuardFacts().connections == 0; })) << "those of before";
    const uint64_t closed = ClosedForHeaders();
    const size_t connections = ReadGuardFacts().connections;
    {
      const Socket good = listener->Connect(http2::Preface());
      EXPECT_TRUE(good.IsGreeted());
      EXPECT_EQ(ReadGuardFacts().connections, connections + 1);
    }
    EXPECT_TRUE(Eventually([&] { return ReadGuardFacts().connections == connections; }));
    const Socket bad = listener->Connect(Attack());
    while (bad.IsGreeted()) {
    }
    EXPECT_EQ(ClosedForHeaders(), closed + 1);
  }
}

TEST_F(SocketAcceptorTest, OutlivesConnectionsThatAreResetAtOnce) {
  Start();
  for (int n = 0; n < 100; ++n) Socket::Reset(v4_.Connect(n % 2 == 0 ? http2::Preface() : ""));
  EXPECT_TRUE(v4_.Connect(http2::Preface()).IsGreeted());
  EXPECT_TRUE(Eventually([] { return ReadGuardFacts().connections == 0; }));
}

TEST_F(SocketAcceptorTest, ServesOneSocketWhileAnotherFails) {
  Start();
  ASSERT_EQ(shutdown(v4_.fd(), SHUT_RD), 0);  // it is ready at all times, and accept4 fails
  for (int n = 0; n < 3; ++n) EXPECT_TRUE(local_.Connect(http2::Preface()).IsGreeted());
}

TEST_F(SocketAcceptorTest, ConnectionsThatComeTooLateWaitForTheNextServer) {
  Start();
  EXPECT_TRUE(server_->Stop(absl::ZeroDuration()));
  const Socket early = v4_.Connect(http2::Preface());
  stub_.reset();
  server_.reset();
  Start();
  EXPECT_TRUE(early.IsGreeted());
}

TEST_F(SocketAcceptorTest, RefusesPlainTextForOthersAsItDoesAtItsAddresses) {
  options_.sockets[1].address = "0.0.0.0:1";
  const auto refused = VoxelServer::Start(options_);
  EXPECT_EQ(refused.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string{refused.status().message()},
              testing::HasSubstr("refusing to listen on 0.0.0.0:1 in plain text"));
}

}  // namespace
}  // namespace latvox
