// A server for one program alone: as the SDK starts it, and as it ends.
#include "client/internal/private_server.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <sstream>
#include <thread>

#include "absl/time/clock.h"
#include "client/internal/process_directory.h"
#include "latvox/client.h"
#include "tests/unit/client/files.h"
#include "tests/unit/server/meshes.h"

namespace latvox::client {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// Replaces latvoxd with a program, and puts the private directory in a visible place.
class Private : public FilesTest {
 protected:
  void Be(const std::string& script) const {
    const std::string program = Write("fake", "#!/bin/sh\n" + script);
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    std::filesystem::create_directory(Path("run"));
    setenv("LATVOX_LATVOXD", program.c_str(), 1);
    setenv("XDG_RUNTIME_DIR", Path("run").c_str(), 1);
  }
  // Starts the server, waits for it, and returns why it does not serve.
  static absl::Status Serve(const PrivateServerOptions& options = {}, const CallOptions& call = {}) {
    const auto server = PrivateServer::Start(options);
    return server.ok() ? (*server)->AwaitReady(call) : server.status();
  }
  ~Private() override {
    unsetenv("LATVOX_LATVOXD");
    unsetenv("XDG_RUNTIME_DIR");
  }
};

// Returns the children of this process, as text.
std::string Children() {
  std::string all;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task")) {
    std::ifstream file(thread.path() / "children");
    all += std::string(std::istreambuf_iterator<char>(file), {});
  }
  return all;
}

TEST_F(Private, AServerThatEndsEarlyIsReportedAndItsDirectoryRemoved) {
  Be("exit 7\n");
  const absl::Status status = Serve();
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(status.message()), HasSubstr("status 7"));
  EXPECT_TRUE(std::filesystem::is_empty(Path("run")));
}

TEST_F(Private, AProgramThatIsMissingIsReported) {
  Be("");
  setenv("LATVOX_LATVOXD", Path("missing").c_str(), 1);
  const absl::Status status = Serve();
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(status.message()), HasSubstr("missing"));
  EXPECT_TRUE(std::filesystem::is_empty(Path("run")));
}

TEST_F(Private, WhatTheEnvironmentSaysOfAServerForOthersIsLeftOut) {
  Be("env > \"$0.variables\"\n");
  setenv("LATVOX_TOKEN_FILE", "/nowhere", 1);
  setenv("LATVOX_MAX_TRIANGLES", "5", 1);
  EXPECT_EQ(Serve().code(), absl::StatusCode::kUnavailable);
  unsetenv("LATVOX_TOKEN_FILE");
  unsetenv("LATVOX_MAX_TRIANGLES");
  EXPECT_THAT(Read("fake.variables"), AllOf(HasSubstr("LATVOX_MAX_TRIANGLES=5"), Not(HasSubstr("TOKEN"))));
}

TEST_F(Private, OneThatNeverServesIsEndedAtTheDeadlineEvenIfItIgnoresSigterm) {
  Be("echo $$ \"$@\" > \"$0.words\"\ntrap '' TERM\nwhile :; do sleep 0.05; done\n");
  CallOptions options;
  options.deadline = absl::Now() + absl::Milliseconds(300);
  EXPECT_EQ(Serve({.threads = 5}, options).code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_TRUE(std::filesystem::is_empty(Path("run")));
  std::istringstream words(Read("fake.words"));
  pid_t pid = 0;
  words >> pid;
  EXPECT_NE(kill(pid, 0), 0);
  EXPECT_THAT(words.str(), HasSubstr("--listen unix:" + Path("run")));
  EXPECT_THAT(words.str(), HasSubstr("--exit-with-parent --decoders-on-demand --log-level warning --threads 5"));
}

TEST_F(Private, OneThatIsAskedToEndIsAskedOnceAndWaitedForLater) {
  Be("trap 'echo TERM >> \"$0.signals\"' TERM\n"
     "touch \"$0.ready\"\n"
     "until [ -e \"$0.signals\" ]; do sleep 0.01; done\n"
     "sleep 0.3\n");
  auto server = PrivateServer::Start({});
  ASSERT_TRUE(server.ok()) << server.status();
  while (!std::filesystem::exists(Path("fake.ready"))) absl::SleepFor(absl::Milliseconds(1));
  (*server)->End();
  while (!std::filesystem::exists(Path("fake.signals"))) absl::SleepFor(absl::Milliseconds(1));
  EXPECT_NE(Children(), "");
  server->reset();
  EXPECT_EQ(Children(), "");
  EXPECT_EQ(Read("fake.signals"), "TERM\n");
}

TEST_F(Private, FilesOfThisProgramAreNotOpenInTheServer) {
  const int inherited = fcntl(STDERR_FILENO, F_DUPFD, 100);
  Be("ls /proc/$$/fd > \"$0.files\"\n");
  EXPECT_EQ(Serve().code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(Read("fake.files"), Not(HasSubstr("\n" + std::to_string(inherited) + "\n")));
  close(inherited);
}

TEST_F(Private, TheDirectoryOfADeadProcessIsRemovedAndThatOfALivingOneStays) {
  Be("exit 7\n");
  const auto living = ProcessDirectory::Make(Path("run"));
  ASSERT_NE(living, nullptr);
  std::filesystem::create_directory(Path("run/latvox-01234567-abcdef"));  // of another kernel
  const pid_t child = fork();
  if (child == 0) {
    const auto dead = ProcessDirectory::Make(Path("run"));
    if (dead != nullptr) std::filesystem::create_directory(dead->path() + "/more");
    kill(getpid(), SIGKILL);
  }
  waitpid(child, nullptr, 0);
  const auto count = [&] {
    return std::distance(std::filesystem::directory_iterator(Path("run")), std::filesystem::directory_iterator());
  };
  EXPECT_EQ(count(), 3);
  EXPECT_EQ(Serve().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(count(), 2);
  EXPECT_TRUE(std::filesystem::exists(living->path()));
}

VoxelizeRequest Small() {
  VoxelizeRequest request;
  request.resolution = 20;
  return request;
}

class StartPrivate : public FilesTest {
 protected:
  StartPrivate() {
    std::filesystem::create_directory(Path("run"));
    setenv("XDG_RUNTIME_DIR", Path("run").c_str(), 1);
  }
  ~StartPrivate() override { unsetenv("XDG_RUNTIME_DIR"); }

  const std::string mesh_ = EncodeDraco(Sphere(10), {});
};

TEST_F(StartPrivate, TheServerVoxelizesAndEndsWithTheClient) {
  {
    const auto client = Client::StartPrivate({.program = LATVOXD, .threads = 1});
    ASSERT_TRUE(client.ok()) << client.status();
    EXPECT_TRUE(std::filesystem::is_empty(Path("run")));
    EXPECT_NE(Children(), "");
    const auto all = client->VoxelizeAll(Small(), mesh_);
    ASSERT_TRUE(all.ok()) << all.status();
    EXPECT_GT(all->summary.voxels, 0U);
  }
  EXPECT_EQ(Children(), "");
}

TEST_F(StartPrivate, TheServerOutlivesTheThreadThatStartedItAndEndsWithTheLastStream) {
  {
    std::optional<BrickStream> stream;
    std::thread([&] {
      const auto client = Client::StartPrivate({.program = LATVOXD});
      ASSERT_TRUE(client.ok()) << client.status();
      stream.emplace(client->Stream(Small(), mesh_));
    }).join();
    ASSERT_TRUE(stream.has_value());
    uint64_t bricks = 0;
    for (const absl::StatusOr<BrickBatch>& batch : *stream) {
      ASSERT_TRUE(batch.ok()) << batch.status();
      bricks += batch->bricks.size();
    }
    EXPECT_GT(bricks, 0U);
    EXPECT_NE(Children(), "");
  }
  EXPECT_EQ(Children(), "");
}

TEST_F(StartPrivate, AMissingProgramIsNamed) {
  EXPECT_EQ(
      Client::StartPrivate({.program = "/missing/latvoxd"}).status(),
      absl::UnavailableError("cannot start /missing/latvoxd: No such file or directory; LATVOX_LATVOXD may name it"));
}

TEST_F(StartPrivate, ACancelledStartLeavesNothing) {
  const CallOptions options;
  options.cancellation.Cancel();
  EXPECT_EQ(Client::StartPrivate({.program = LATVOXD}, options).status().code(), absl::StatusCode::kCancelled);
  EXPECT_EQ(Children(), "");
  EXPECT_TRUE(std::filesystem::is_empty(Path("run")));
}

}  // namespace
}  // namespace latvox::client
