#include "deploy/process/exhaustion.h"

#include <malloc.h>
#include <pthread.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <latch>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include "absl/strings/str_cat.h"

namespace latvox {
namespace {

// Larger than a thread's stack, so a thread that could not start is among the reasons.
constexpr size_t kProbeBytes = size_t{64} << 20;

// Addresses for each arena of the heap. An arena may take 128 MiB for a moment.
constexpr uint64_t kBytesOfArena = uint64_t{2} << 30;

// The stack of a thread that only waits. ARM's least stack is larger.
constexpr size_t kSmallStack = size_t{64} << 10;

bool CanMap(size_t bytes) {
  constexpr int kFlags = MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE;
  void* const probe = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, kFlags, -1, 0);
  if (probe == MAP_FAILED) return false;
  munmap(probe, bytes);
  return true;
}

absl::Status NoMemory(const std::string& more = "") {
  const uint64_t limit = AddressLimit();
  const std::string within =
      limit == UINT64_MAX ? "" : absl::StrCat(" within the limit of ", limit / 1024, " KiB (ulimit -v)");
  return absl::ResourceExhaustedError(absl::StrCat(kNoMemory, within, more));
}

}  // namespace

bool IsMemoryGone() { return !CanMap(kProbeBytes); }

// The system counts processes as threads. No fork(), which runs the handlers of libraries.
bool AreThreadsGone() {
  const auto child = static_cast<pid_t>(syscall(SYS_clone, SIGCHLD, nullptr, nullptr, nullptr, nullptr));
  if (child == 0) syscall(SYS_exit_group, 0);
  if (child < 0) return errno == EAGAIN;
  waitpid(child, nullptr, 0);
  return false;
}

absl::Status StatusOf(const std::exception& error) {
  if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) return NoMemory();
  const auto* const system = dynamic_cast<const std::system_error*>(&error);
  if (system == nullptr || system->code() != std::errc::resource_unavailable_try_again) {
    return absl::UnknownError(error.what());
  }
  return IsMemoryGone() ? NoMemory() : absl::ResourceExhaustedError(kNoThread);
}

uint64_t AddressLimit() {
  rlimit limit{};
  return getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY ? limit.rlim_cur : UINT64_MAX;
}

void SpareAddresses() {
  const uint64_t limit = AddressLimit();
  if (limit == UINT64_MAX) return;
  mallopt(M_ARENA_MAX, static_cast<int>(std::clamp<uint64_t>(limit / kBytesOfArena, 1, 64)));
}

uint64_t SpareStacks(uint64_t most) {
  pthread_attr_t attributes;
  size_t bytes = 0;
  if (pthread_getattr_default_np(&attributes) != 0) return most;
  pthread_attr_getstacksize(&attributes, &bytes);
  if (AddressLimit() != UINT64_MAX && bytes > most) {
    pthread_attr_setstacksize(&attributes, most);
    if (pthread_setattr_default_np(&attributes) == 0) bytes = most;
  }
  pthread_attr_destroy(&attributes);
  return bytes;
}

absl::Status CheckAddresses(uint64_t bytes) {
  if (CanMap(bytes)) return absl::OkStatus();
  return NoMemory(absl::StrCat(": ", bytes / 1024, " KiB more are needed"));
}

bool HasAddressesForThreads() {
  constexpr uint64_t kForThreads = uint64_t{128} << 20;
  return CheckAddresses(kForThreads).ok();
}

absl::Status CheckThreads(int count) {
  pthread_attr_t attributes;
  if (pthread_attr_init(&attributes) != 0) return NoMemory();
  pthread_attr_setstacksize(&attributes, std::max(kSmallStack, static_cast<size_t>(PTHREAD_STACK_MIN)));
  std::latch counted(1);
  const auto wait = [](void* latch) -> void* {
    static_cast<std::latch*>(latch)->wait();
    return nullptr;
  };
  std::vector<pthread_t> threads(static_cast<size_t>(count));
  const auto end = std::ranges::find_if(
      threads, [&](pthread_t& thread) { return pthread_create(&thread, &attributes, wait, &counted) != 0; });
  counted.count_down();
  std::for_each(threads.begin(), end, [](pthread_t thread) { pthread_join(thread, nullptr); });
  pthread_attr_destroy(&attributes);
  if (end == threads.end()) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat(kNoThread, ": ", count, " more are needed"));
}

}  // namespace latvox
