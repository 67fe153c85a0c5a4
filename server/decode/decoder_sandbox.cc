#include "server/decode/decoder_sandbox.h"

#include <fcntl.h>
#include <linux/futex.h>
#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <memory>

#include "absl/strings/str_cat.h"
#include "deploy/process/child.h"
#include "server/decode/decoder_process.h"

namespace latvox {
namespace {

// Standard input, output and error, which lead nowhere, and the channel.
constexpr rlim_t kOpenFiles = 4;

// Raises the process's score, which needs no privilege. Without /proc, the kernel chooses by size alone.
void BeKilledFirst() {
  const int file = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
  if (file < 0) return;
  static_cast<void>(!write(file, "1000", 4));
  close(file);
}

absl::Status Failed(absl::string_view step) { return absl::InternalError(absl::StrCat(step, ": ", strerror(errno))); }

absl::Status AddRules(scmp_filter_ctx filter, int channel) {
  const auto fd = static_cast<scmp_datum_t>(channel);
  const auto allow = [&](int call, std::initializer_list<scmp_arg_cmp> arguments) {
    return seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, call, static_cast<unsigned>(arguments.size()),
                                  std::data(arguments));
  };
  int error = 0;
  const auto note = [&error](int result) { error = error != 0 ? error : result; };
  for (const int call : {SCMP_SYS(read), SCMP_SYS(write), SCMP_SYS(writev)}) {
    note(allow(call, {SCMP_A0_64(SCMP_CMP_EQ, fd)}));
  }
  // malloc's calls
  note(allow(SCMP_SYS(brk), {}));
  note(allow(SCMP_SYS(mmap), {SCMP_A2_64(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0),
                              SCMP_A3_64(SCMP_CMP_MASKED_EQ, MAP_ANONYMOUS, MAP_ANONYMOUS)}));
  note(allow(SCMP_SYS(mremap), {}));
  note(allow(SCMP_SYS(munmap), {}));
  note(allow(SCMP_SYS(madvise), {}));
  // pthread_once calls it at its end, for example in the first exception, although no thread waits.
  note(allow(SCMP_SYS(futex), {SCMP_A1_64(SCMP_CMP_EQ, FUTEX_WAKE_PRIVATE)}));
  note(allow(SCMP_SYS(exit_group), {}));
  if (error == 0) return absl::OkStatus();
  return absl::InternalError(absl::StrCat("a rule of seccomp: ", strerror(-error)));
}

}  // namespace

absl::Status LimitSelf(pid_t parent, uint64_t memory) {
  if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) return Failed("PR_SET_PDEATHSIG");
  if (getppid() != parent) return absl::InternalError("the server has ended");  // it ended before the call of prctl
  BeKilledFirst();
  if (prctl(PR_SET_DUMPABLE, 0) != 0) return Failed("PR_SET_DUMPABLE");
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return Failed("PR_SET_NO_NEW_PRIVS");
  if (kUnderSanitizer) return absl::OkStatus();
  if (!SetLimit(RLIMIT_CORE, 0)) return Failed("RLIMIT_CORE");
  if (!SetLimit(RLIMIT_FSIZE, 0)) return Failed("RLIMIT_FSIZE");
  const uint64_t in_use = AddressesInUse();
  if (in_use == 0) return absl::InternalError("/proc/self/statm cannot be read");
  if (memory != kNoMemoryLimit && !SetLimit(RLIMIT_AS, in_use + memory)) return Failed("RLIMIT_AS");
  if (!SetLimit(RLIMIT_NOFILE, kOpenFiles)) return Failed("RLIMIT_NOFILE");
  return absl::OkStatus();
}

absl::Status ForbidSystemCalls(int channel) {
  if (kUnderSanitizer) return absl::OkStatus();
  const std::unique_ptr<void, void (*)(scmp_filter_ctx)> filter(seccomp_init(SCMP_ACT_KILL_PROCESS), &seccomp_release);
  if (!filter) return absl::UnavailableError("seccomp: it is not there");
  if (absl::Status status = AddRules(filter.get(), channel); !status.ok()) return status;
  if (const int error = seccomp_load(filter.get()); error != 0) {
    return absl::UnavailableError(absl::StrCat("seccomp: ", strerror(-error)));
  }
  return absl::OkStatus();
}

}  // namespace latvox
