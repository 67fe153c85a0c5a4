#include "client/tool/confined/reader_sandbox.h"

#include <seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <initializer_list>
#include <memory>

#include "absl/strings/str_cat.h"
#include "deploy/process/child.h"

namespace latvox::client {
namespace {

absl::Status Failed(const char* step) { return absl::InternalError(absl::StrCat(step, ": ", std::strerror(errno))); }

absl::Status SetLimits(const ReaderLimits& limits) {
  if (!SetLimit(RLIMIT_CPU, limits.seconds, limits.seconds + 1)) return Failed("RLIMIT_CPU");
  if (!SetLimit(RLIMIT_CORE, 0)) return Failed("RLIMIT_CORE");
  if (kAddressSanitizer) return absl::OkStatus();
  const uint64_t in_use = AddressesInUse();
  if (in_use == 0) return absl::InternalError("/proc/self/statm cannot be read");
  if (!SetLimit(RLIMIT_AS, in_use + limits.memory)) return Failed("RLIMIT_AS");
  if (!SetLimit(RLIMIT_FSIZE, 0)) return Failed("RLIMIT_FSIZE");
  if (!SetLimit(RLIMIT_NOFILE, kReaderChannel + 1)) return Failed("RLIMIT_NOFILE");
  return absl::OkStatus();
}

// Returns 0 or an error of libseccomp.
int AddRules(scmp_filter_ctx filter) {
  int error = 0;
  const auto allow = [&](int call, std::initializer_list<scmp_arg_cmp> arguments) {
    const int result = seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, call, static_cast<unsigned>(arguments.size()),
                                              std::data(arguments));
    error = error != 0 ? error : result;
  };
  for (const int call : {SCMP_SYS(read), SCMP_SYS(readv), SCMP_SYS(pread64), SCMP_SYS(lseek)}) {
    allow(call, {SCMP_A0_64(SCMP_CMP_EQ, kReaderFile)});
  }
  allow(SCMP_SYS(write), {SCMP_A0_64(SCMP_CMP_EQ, kReaderChannel)});
  // malloc's calls
  allow(SCMP_SYS(brk), {});
  allow(SCMP_SYS(mmap),
        {SCMP_A2_64(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0), SCMP_A3_64(SCMP_CMP_MASKED_EQ, MAP_ANONYMOUS, MAP_ANONYMOUS)});
  allow(SCMP_SYS(mprotect), {SCMP_A2_64(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0)});
  allow(SCMP_SYS(mremap), {});
  allow(SCMP_SYS(munmap), {});
  allow(SCMP_SYS(madvise), {});
  // locks
  allow(SCMP_SYS(futex), {});
  allow(SCMP_SYS(sched_yield), {});
  // A thread of OpenVDB's library may still be starting. It would abort the process if these calls failed.
  for (const int call : {SCMP_SYS(rseq), SCMP_SYS(set_robust_list), SCMP_SYS(rt_sigprocmask)}) allow(call, {});
  allow(SCMP_SYS(exit_group), {});
  return error;
}

// OpenVDB's library has threads of its own, so the filter is for all threads.
void ForbidSystemCalls() {
  const std::unique_ptr<void, void (*)(scmp_filter_ctx)> filter(seccomp_init(SCMP_ACT_ERRNO(EPERM)), &seccomp_release);
  if (!filter || seccomp_attr_set(filter.get(), SCMP_FLTATR_CTL_TSYNC, 1) != 0) return;
  if (AddRules(filter.get()) == 0) seccomp_load(filter.get());
}

}  // namespace

absl::Status ConfineReader(pid_t parent, const ReaderLimits& limits) {
  if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) return Failed("PR_SET_PDEATHSIG");
  if (getppid() != parent) return absl::InternalError("the parent has ended");  // it ended before the call of prctl
  if (prctl(PR_SET_DUMPABLE, 0) != 0) return Failed("PR_SET_DUMPABLE");
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return Failed("PR_SET_NO_NEW_PRIVS");
  if (auto status = SetLimits(limits); !status.ok()) return status;
  if (!kAddressSanitizer) ForbidSystemCalls();
  return absl::OkStatus();
}

}  // namespace latvox::client
