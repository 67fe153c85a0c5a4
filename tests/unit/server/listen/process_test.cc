// latvoxd as a process: options, exit status, signals.
#include "tests/unit/server/process.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <future>
#include <iterator>
#include <map>
#include <memory>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include "absl/synchronization/notification.h"
#include "latvox/v1/voxelizer.grpc.pb.h"
#include "tests/unit/temporary_directory.h"

namespace latvox {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::UnorderedElementsAre;

TEST(Latvoxd, EndsCleanlyOnEachOfItsSignals) {
  for (const int signal : {SIGTERM, SIGINT}) {
    const TemporaryDirectory directory;
    const std::string path = directory / "socket";
    Process server(Latvoxd({"--listen", "unix:" + path}));
    server.ReadUntil("event=listening address=unix:" + path);
    EXPECT_TRUE(std::filesystem::exists(path));
    kill(server.pid(), signal);
    EXPECT_THAT(server.ReadAll(), HasSubstr("event=stopped"));
    EXPECT_EQ(server.Wait(), 0);
    EXPECT_FALSE(std::filesystem::exists(path));
  }
}

// A server on a socket that has begun a call without end.
class BusyServer {
 public:
  explicit BusyServer(const std::string& address)
      : process(Latvoxd({"--listen", address, "--grace", "60", "--max-jobs", "1", "--max-queued-jobs", "0"})) {
    process.ReadUntil("event=listening");
    stub_ = v1::Voxelizer::NewStub(grpc::CreateChannel(address, grpc::InsecureChannelCredentials()));
    // There is room for one of two, whichever comes first: it has arrived once the other is refused.
    for (std::future<grpc::StatusCode>& call : calls_) call = std::async(std::launch::async, [this] { return Call(); });
    refused_.WaitForNotification();
  }

  std::vector<grpc::StatusCode> Ends() { return {calls_[0].get(), calls_[1].get()}; }

  Process process;

 private:
  grpc::StatusCode Call() {
    grpc::ClientContext context;
    context.set_wait_for_ready(true);
    const auto stream = stub_->Voxelize(&context);
    v1::VoxelizeRequest request;
    request.mutable_spec()->mutable_lattice()->set_named(v1::NAMED_LATTICE_BCC);
    request.mutable_spec()->set_resolution(9);
    stream->Write(request);
    const grpc::StatusCode code = stream->Finish().error_code();
    if (code == grpc::StatusCode::RESOURCE_EXHAUSTED) refused_.Notify();
    return code;
  }

  std::unique_ptr<v1::Voxelizer::Stub> stub_;
  absl::Notification refused_;
  std::array<std::future<grpc::StatusCode>, 2> calls_;
};

TEST(Latvoxd, EndsAtOnceOnASecondSignal) {
  const TemporaryDirectory directory;
  const std::string path = directory / "socket";
  BusyServer server("unix:" + path);
  kill(server.process.pid(), SIGTERM);
  EXPECT_EQ(server.process.ReadLineWith("event=stopping reason="), "SIGTERM calls=1 grace=1m");
  kill(server.process.pid(), SIGTERM);
  EXPECT_EQ(server.process.Wait(), 1);
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_THAT(server.Ends(), UnorderedElementsAre(grpc::StatusCode::RESOURCE_EXHAUSTED, grpc::StatusCode::UNAVAILABLE));
}

// That another server has begun to listen where this one did.
TEST(Latvoxd, LeavesASocketAloneThatIsNotItsOwnAnyMore) {
  const TemporaryDirectory directory;
  const std::string path = directory / "socket";
  BusyServer first("unix:" + path);
  std::filesystem::remove(path);
  Process second(Latvoxd({"--listen", "unix:" + path}));
  second.ReadUntil("event=listening");
  kill(first.process.pid(), SIGTERM);
  first.process.ReadUntil("event=stopping");
  kill(first.process.pid(), SIGTERM);
  EXPECT_EQ(first.process.Wait(), 1);
  EXPECT_TRUE(std::filesystem::exists(path));

  std::filesystem::remove(path);
  Process third(Latvoxd({"--listen", "unix:" + path}));
  third.ReadUntil("event=listening");
  kill(second.pid(), SIGTERM);
  EXPECT_EQ(second.Wait(), 0);
  EXPECT_TRUE(std::filesystem::exists(path));
  kill(third.pid(), SIGTERM);
  EXPECT_EQ(third.Wait(), 0);
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(Latvoxd, SaysInOneLineWhichAddressIsInUse) {
  Process first(Latvoxd({"--listen", "127.0.0.1:0"}));
  const std::string address = first.ReadLineWith("event=listening address=");
  Process second(Latvoxd({"--listen", address}));
  EXPECT_EQ(second.ReadAll(), "latvoxd: cannot listen on " + address +
                                  ": the address is in use, not of this machine, or not permitted\n");
  EXPECT_EQ(second.Wait(), 1);
}

TEST(Latvoxd, TakesOptionsFromTheCommandLineThenTheEnvironmentThenTheFile) {
  const TemporaryDirectory files;
  const std::string& directory = files.path();
  std::ofstream(directory + "/latvoxd.toml") << "listen = [\"unix:" << directory << "/file\"]\n"
                                             << "max-jobs = 1\nmax-triangles = 2\nlog-level = \"info\"\n"
                                             << "max-mesh-bytes = \"3MiB\"\n";
  Process server({"env", "LATVOX_LISTEN=unix:" + directory + "/environment", "LATVOX_MAX_TRIANGLES=5", LATVOXD,
                  "--config", directory + "/latvoxd.toml", "--listen", "unix:" + directory + "/flag"});
  EXPECT_EQ(server.ReadLineWith("event=listening address="), "unix:" + directory + "/flag");
  const auto stub =
      v1::Voxelizer::NewStub(grpc::CreateChannel("unix:" + directory + "/flag", grpc::InsecureChannelCredentials()));
  grpc::ClientContext context;
  context.set_wait_for_ready(true);
  v1::GetLimitsResponse limits;
  ASSERT_TRUE(stub->GetLimits(&context, {}, &limits).ok());
  EXPECT_EQ(limits.max_jobs(), 1);
  EXPECT_EQ(limits.max_triangles(), 5);
  EXPECT_EQ(limits.max_mesh_bytes(), 3 << 20);
}

std::vector<std::string> PeersOfRequests(const std::string& log) {
  std::vector<std::string> peers;
  const std::regex peer("event=request .*peer=(\\S+)");
  for (std::sregex_iterator found(log.begin(), log.end(), peer), end; found != end; ++found)
    peers.push_back((*found)[1]);
  return peers;
}

TEST(Latvoxd, RenewsConnectionsOfTheAgeThatItIsToldAndLetsTheirCallsEnd) {
  Process server(Latvoxd({"--listen", "127.0.0.1:0", "--max-connection-age", "1"}));
  Process patient(Latvoxd({"--listen", "127.0.0.1:0"}));
  const auto connect = [](Process& to) {
    return grpc::CreateChannel(to.ReadLineWith("event=listening address="), grpc::InsecureChannelCredentials());
  };
  const auto lasting = connect(patient), channel = connect(server);
  const auto stub = v1::Voxelizer::NewStub(channel);
  const auto deadline = [] { return std::chrono::system_clock::now() + std::chrono::seconds(20); };
  ASSERT_TRUE(lasting->WaitForConnected(deadline()));
  grpc::ClientContext long_context;
  const auto long_call = stub->Voxelize(&long_context);
  v1::VoxelizeRequest request;
  request.mutable_spec()->mutable_lattice()->set_named(v1::NAMED_LATTICE_BCC);
  request.mutable_spec()->set_resolution(9);
  ASSERT_TRUE(long_call->Write(request));
  const auto short_call = [&] {
    grpc::ClientContext context;
    const auto stream = stub->Voxelize(&context);
    stream->WritesDone();
    return stream->Finish().error_code();
  };
  EXPECT_EQ(short_call(), grpc::StatusCode::INVALID_ARGUMENT);
  ASSERT_TRUE(channel->WaitForStateChange(GRPC_CHANNEL_READY, deadline()));
  EXPECT_EQ(lasting->GetState(false), GRPC_CHANNEL_READY);
  EXPECT_EQ(short_call(), grpc::StatusCode::INVALID_ARGUMENT);
  long_call->WritesDone();
  EXPECT_EQ(long_call->Finish().error_code(), grpc::StatusCode::INVALID_ARGUMENT);  // no mesh, as the server says
  kill(server.pid(), SIGTERM);
  const std::vector<std::string> peers = PeersOfRequests(server.ReadAll());
  ASSERT_EQ(peers.size(), 3);
  // The long call had the connection of the first short one, the second short one another. Which of the two ended first
  // is up to the server.
  EXPECT_EQ(std::count(peers.begin(), peers.end(), peers[0]), 2);
}

TEST(Latvoxd, RunsWithTheInstructionsThatItIsTold) {
  Process server(Latvoxd({"--listen", "127.0.0.1:0", "--simd", "scalar"}));
  EXPECT_THAT(server.ReadUntil("simd=scalar"), HasSubstr("simd=scalar"));
}

TEST(Latvoxd, RefusesWrongUsageWithStatusTwo) {
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"--no-such-option"}, {"--max-jobs", "0"}, {"--log-level", "loud"}, {"--grace", "-1"}, {"extra"}}) {
    Process server(Latvoxd(arguments));
    EXPECT_FALSE(server.ReadAll().empty());
    EXPECT_EQ(server.Wait(), 2) << arguments[0];
  }
}

TEST(Latvoxd, RefusesUnknownKeysOfItsFile) {
  const TemporaryDirectory directory;
  const std::string path = directory / "latvoxd.toml";
  std::ofstream(path) << "max-jbs = 3\n";
  Process server(Latvoxd({"--config", path}));
  EXPECT_THAT(server.ReadAll(), HasSubstr("max-jbs"));
  EXPECT_EQ(server.Wait(), 2);
}

TEST(Latvoxd, TellsItsVersion) {
  Process server(Latvoxd({"--version"}));
  EXPECT_THAT(server.ReadAll(),
              MatchesRegex("latvoxd " LATVOX_VERSION "\ncommit [0-9a-z-]+\nbuilt with .*gRPC [0-9.]+, .*\n"));
  EXPECT_EQ(server.Wait(), 0);
}

TEST(Latvoxd, EndsWithItsParentIfItWasAskedTo) {
  prctl(PR_SET_CHILD_SUBREAPER, 1);  // so that the orphan becomes a child of this process
  const TemporaryDirectory directory;
  const std::string path = directory / "socket";
  Process shell({"sh", "-c", std::string(LATVOXD) + " --exit-with-parent --listen unix:" + path + " & sleep 60"});
  shell.ReadUntil("event=listening");
  kill(shell.pid(), SIGKILL);
  EXPECT_THAT(shell.ReadUntil("event=stopped"), HasSubstr("event=stopping reason=parent-exit"));
  shell.Wait();
  for (int status = 0; waitpid(-1, &status, WNOHANG) > 0;) {
  }
  prctl(PR_SET_CHILD_SUBREAPER, 0);
}

TEST(Latvoxd, EndsIfItsParentEndedBeforeItBegan) {
  Process parent({"true"});
  const pid_t ended = parent.pid();
  parent.Wait();
  const TemporaryDirectory directory;
  Process server(Latvoxd(
      {"--exit-with-parent", "--parent-pid", std::to_string(ended), "--listen", "unix:" + directory / "socket"}));
  EXPECT_THAT(server.ReadAll(), HasSubstr("event=stopping reason=parent-exit"));
  EXPECT_EQ(server.Wait(), 0);
}

std::vector<pid_t> ChildrenOf(pid_t pid) {
  std::vector<pid_t> children;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/task")) {
    std::ifstream file(thread.path() / "children");
    std::copy(std::istream_iterator<pid_t>(file), {}, std::back_inserter(children));
  }
  return children;
}

// As a script does that starts latvoxd as a child of its own.
TEST(Latvoxd, TakesAProgramBetweenItAndItsParentForTheParent) {
  const TemporaryDirectory directory;
  const std::string path = directory / "socket";
  const std::string command = std::string(LATVOXD) + " --exit-with-parent --parent-pid " + std::to_string(getpid()) +
                              " --listen unix:" + path + "; true";
  Process shell({"sh", "-c", command});
  shell.ReadUntil("event=listening");
  const std::vector<pid_t> servers = ChildrenOf(shell.pid());
  ASSERT_EQ(servers.size(), 1U);
  kill(servers[0], SIGTERM);
  EXPECT_THAT(shell.ReadAll(), HasSubstr("event=stopping reason=SIGTERM"));
  EXPECT_EQ(shell.Wait(), 0);
}

// How many threads for large jobs a process has, by their niceness beyond the process's.
std::map<int, int> NicenessOfBulk(pid_t pid) {
  std::map<int, int> threads;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/" + std::to_string(pid) + "/task")) {
    std::string name;
    std::getline(std::ifstream(thread.path() / "comm"), name);
    const auto number = static_cast<id_t>(std::stoi(thread.path().filename()));
    if (name == "latvoxd-bulk") {
      ++threads[getpriority(PRIO_PROCESS, number) - getpriority(PRIO_PROCESS, static_cast<id_t>(pid))];
    }
  }
  return threads;
}

TEST(Latvoxd, LowersThePriorityOfLargeJobsUnlessItIsPrivate) {
  const TemporaryDirectory directory;
  const std::string path = directory / "socket";
  for (const bool is_private : {false, true}) {
    std::vector<std::string> options{"--listen", "unix:" + path, "--threads", "3"};
    if (is_private) options.emplace_back("--exit-with-parent");
    Process server(Latvoxd(options));
    server.ReadUntil("event=listening");
    const std::map<int, int> expected =
        is_private ? std::map<int, int>{} : std::map<int, int>{{10, 4}};  // one for each lane
    // The threads may have been started only.
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (NicenessOfBulk(server.pid()) != expected && std::chrono::steady_clock::now() < patience) usleep(1000);
    EXPECT_EQ(NicenessOfBulk(server.pid()), expected);
  }
}

// The process that inherits an orphan need not have reaped it.
bool IsAlive(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/status");
  const std::string status(std::istreambuf_iterator<char>(file), {});
  return !status.empty() && status.find("State:\tZ") == std::string::npos;
}

TEST(Latvoxd, LeavesNoDecoderProcessBehindHoweverItEnds) {
  for (const auto& [signal, is_private] :
       {std::pair(SIGTERM, false), {SIGTERM, true}, {SIGKILL, false}, {SIGSEGV, false}}) {
    std::vector<std::string> options{"--listen", "127.0.0.1:0", "--decoder-processes", "3"};
    if (is_private) options.emplace_back("--exit-with-parent");
    Process server(Latvoxd(options));
    server.ReadUntil("event=listening");
    const std::vector<pid_t> decoders = ChildrenOf(server.pid());
    EXPECT_EQ(decoders.size(), 3);
    kill(server.pid(), signal);
    server.Wait();
    for (const pid_t pid : decoders) {
      for (int n = 0; n < 1000 && IsAlive(pid); ++n) usleep(2000);
      EXPECT_FALSE(IsAlive(pid)) << "after signal " << signal;
    }
  }
}

TEST(Latvoxd, LogsTheEndOfADecoderProcess) {
  Process server(Latvoxd({"--listen", "127.0.0.1:0", "--decoder-processes", "1"}));
  server.ReadUntil("event=listening");
  const std::vector<pid_t> decoders = ChildrenOf(server.pid());
  ASSERT_EQ(decoders.size(), 1);
  kill(decoders[0], SIGKILL);
  EXPECT_EQ(server.ReadLineWith("level=warning event=decoder_died pid="),
            std::to_string(decoders[0]) + " end=\"signal 9 (Killed)\" bytes=0");
}

TEST(Latvoxd, EndsCleanlyAsProcessOne) {
  if (geteuid() != 0) GTEST_SKIP() << "only root may make a process namespace";
  Process outer({"unshare", "--pid", "--fork", "--kill-child", LATVOXD, "--listen", "127.0.0.1:0"});
  ASSERT_THAT(outer.ReadUntil("event=listening"), HasSubstr("event=started"));
  EXPECT_THAT(outer.ReadUntil("event=listening"), HasSubstr("pid=1\n"));
  const std::string pid = std::to_string(outer.pid());
  pid_t server = 0;
  std::ifstream("/proc/" + pid + "/task/" + pid + "/children") >> server;
  ASSERT_GT(server, 0);
  kill(server, SIGTERM);
  EXPECT_THAT(outer.ReadAll(), HasSubstr("event=stopped"));
  EXPECT_EQ(outer.Wait(), 0);
}

}  // namespace
}  // namespace latvox
