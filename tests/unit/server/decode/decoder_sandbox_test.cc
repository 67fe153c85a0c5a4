// The actions that a confined process cannot take. Each attempt is made by a process of its own, which it costs its
// life.
#include "server/decode/decoder_sandbox.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>

#include "absl/strings/match.h"
#include "deploy/process/child.h"
#include "server/decode/decoder_pool.h"
#include "tests/unit/server/decoders.h"
#include "tests/unit/temporary_directory.h"

namespace latvox {
namespace {

using ::testing::HasSubstr;

constexpr uint64_t kMemory = uint64_t{64} << 20;

// Runs `work` in a child and returns its exit status, or minus the signal that ended it.
int InChild(const std::function<int()>& work) {
  const pid_t pid = fork();
  if (pid == 0) syscall(SYS_exit_group, work());
  int status = 0;
  waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

// The same in a child that is confined to one end of a socket.
int Confined(const std::function<int(int channel)>& work) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) return 1000;
  const pid_t parent = getpid();
  const int result = InChild([&] {
    if (!LimitSelf(parent, kMemory).ok()) return 200;
    if (!ForbidSystemCalls(ends[1]).ok()) return 201;
    return work(ends[1]);
  });
  close(ends[0]);
  close(ends[1]);
  return result;
}

TEST(DecoderSandbox, AllowsWhatDecodingNeeds) {
  EXPECT_EQ(Confined([](int channel) {
              char bytes[] = "12345678";
              iovec part{bytes, 8};
              if (write(channel, bytes, 8) != 8 || writev(channel, &part, 1) != 8) return 1;
              for (size_t size = 1; size < kMemory / 2; size *= 2) {
                void* memory = std::malloc(size);
                if (memory == nullptr) return 2;
                memory = std::realloc(memory, size + size / 2);
                std::free(memory);
              }
              return 0;
            }),
            0);
}

TEST(DecoderSandbox, EndsWhoeverTriesMore) {
  static int open_file = open("/proc/self/exe", O_RDONLY);
  const TemporaryDirectory directory;
  const std::string file = directory / "file";
  const std::pair<const char*, std::function<int(int)>> attempts[] = {
      {"open", [](int) { return open("/etc/passwd", O_RDONLY); }},
      {"openat", [](int) { return openat(AT_FDCWD, ".", O_RDONLY | O_DIRECTORY); }},
      {"create", [&](int) { return open(file.c_str(), O_CREAT | O_WRONLY, 0600); }},
      {"unlink", [&](int) { return unlink(file.c_str()); }},
      {"socket", [](int) { return socket(AF_INET, SOCK_STREAM, 0); }},
      {"local socket", [](int) { return socket(AF_UNIX, SOCK_STREAM, 0); }},
      {"connect", [](int channel) { return connect(channel, nullptr, 0); }},
      {"sendmsg", [](int channel) { return static_cast<int>(sendmsg(channel, nullptr, 0)); }},
      {"recvmsg", [](int channel) { return static_cast<int>(recvmsg(channel, nullptr, 0)); }},
      {"read elsewhere",
       [](int) {
         char c;
         return static_cast<int>(read(open_file, &c, 1));
       }},
      {"write elsewhere", [](int) { return static_cast<int>(write(STDERR_FILENO, "x", 1)); }},
      {"map a file",
       [](int) { return mmap(nullptr, 4096, PROT_READ, MAP_PRIVATE, open_file, 0) == MAP_FAILED ? 1 : 0; }},
      {"map code",
       [](int) {
         constexpr int kFlags = MAP_PRIVATE | MAP_ANONYMOUS;
         return mmap(nullptr, 4096, PROT_READ | PROT_WRITE | PROT_EXEC, kFlags, -1, 0) == MAP_FAILED ? 1 : 0;
       }},
      {"make code",
       [](int) {
         void* const page = mmap(nullptr, 4096, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
         return mprotect(page, 4096, PROT_READ | PROT_EXEC);
       }},
      {"fork", [](int) { return static_cast<int>(fork()); }},
      {"thread", [](int) { return static_cast<int>(syscall(SYS_clone, CLONE_THREAD | CLONE_VM | CLONE_SIGHAND)); }},
      {"exec", [](int) { return execl("/bin/true", "true", nullptr); }},
      {"kill", [](int) { return kill(getppid(), 0); }},
      {"ptrace", [](int) { return static_cast<int>(ptrace(PTRACE_TRACEME, 0, nullptr, nullptr)); }},
      {"raise a limit",
       [](int) {
         const rlimit more{kMemory, kMemory};
         return setrlimit(RLIMIT_AS, &more);
       }},
      {"survive the server", [](int) { return prctl(PR_SET_PDEATHSIG, 0); }},
  };
  for (const auto& [name, attempt] : attempts) EXPECT_EQ(Confined(attempt), -SIGSYS) << name;
  EXPECT_TRUE(std::filesystem::is_empty(directory.path()));
}

TEST(DecoderSandbox, LimitsMemoryAndFiles) {
  const pid_t parent = getpid();
  EXPECT_EQ(InChild([&] {
              if (!LimitSelf(parent, kMemory).ok()) return 1;
              if (std::malloc(kMemory / 2) == nullptr) return 2;
              if (std::malloc(kMemory) != nullptr) return 3;
              int fds = 0;
              while (dup(STDIN_FILENO) >= 0) ++fds;
              if (errno != EMFILE || fds > 1) return 4;
              rlimit core{};
              if (getrlimit(RLIMIT_CORE, &core) != 0 || core.rlim_max != 0) return 5;
              return prctl(PR_GET_DUMPABLE) == 0 ? 0 : 6;
            }),
            0);
}

TEST(DecoderSandbox, KeepsALowerLimitOfTheSystem) {
  const pid_t parent = getpid();
  EXPECT_EQ(InChild([&] {
              // Without its privileges, the process cannot raise a hard limit.
              const rlimit low{AddressesInUse() + kMemory / 2, AddressesInUse() + kMemory / 2};
              if (setrlimit(RLIMIT_AS, &low) != 0) return 1;
              if (geteuid() == 0 && setuid(65534) != 0) return 2;
              if (!LimitSelf(parent, kMemory).ok()) return 3;
              rlimit limit{};
              getrlimit(RLIMIT_AS, &limit);
              return limit.rlim_max == low.rlim_max && limit.rlim_cur == low.rlim_cur ? 0 : 4;
            }),
            0);
}

TEST(DecoderSandbox, EndsWithItsServer) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  // A server that dies at once, and its process, which holds the pipe for as long as it lives.
  EXPECT_EQ(InChild([&] {
              const pid_t server = getpid();
              if (fork() == 0) {
                if (!LimitSelf(server, kMemory).ok()) _exit(1);
                if (write(ends[1], "x", 1) == 1) pause();
                _exit(0);
              }
              char c;
              return read(ends[0], &c, 1) == 1 ? 0 : 1;
            }),
            0);
  close(ends[1]);
  char c;
  EXPECT_EQ(read(ends[0], &c, 1), 0);
  close(ends[0]);
}

TEST(DecoderSandbox, IsRefusedToWhoHasLostItsServer) {
  EXPECT_EQ(InChild([] { return LimitSelf(1 << 22, kMemory).ok() ? 1 : 0; }), 0);
}

// As in a container that does not allow filters.
void RefuseFilters() {
  scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
  seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(seccomp), 0);
  seccomp_rule_add(filter, SCMP_ACT_ERRNO(EPERM), SCMP_SYS(prctl), 1, SCMP_A0_64(SCMP_CMP_EQ, PR_SET_SECCOMP));
  seccomp_load(filter);
}

TEST(DecoderSandbox, WhereItIsNotAllowedThereIsNoDecoderUnlessToldOtherwise) {
  EXPECT_EQ(InChild([] {
              RefuseFilters();
              DecoderOptions options = TestDecoders();
              const auto refused = DecoderPool::Create(options);
              if (refused.ok()) return 1;
              if (!absl::StrContains(refused.status().message(), "seccomp")) return 2;
              options.may_be_unconfined = true;
              return DecoderPool::Create(options).ok() ? 0 : 3;
            }),
            0);
}

}  // namespace
}  // namespace latvox
