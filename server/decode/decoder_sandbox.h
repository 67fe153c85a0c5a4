// Confinement of a decoder process.
#ifndef LATVOX_SERVER_DECODE_DECODER_SANDBOX_H_
#define LATVOX_SERVER_DECODE_DECODER_SANDBOX_H_

#include <sys/types.h>

#include <cstdint>

#include "absl/status/status.h"

namespace latvox {

// AddressSanitizer and ThreadSanitizer take terabytes of address space, need files, and make more system calls than
// malloc. A build with one of them, for tests, does not confine its decoders.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kUnderSanitizer = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
inline constexpr bool kUnderSanitizer = true;
#else
inline constexpr bool kUnderSanitizer = false;
#endif
#else
inline constexpr bool kUnderSanitizer = false;
#endif

// Ties the process to `parent`, so that both end together. Forbids core files, tracing, more privileges, and opening or
// growing files. Makes the process the kernel's first choice when memory is short. It may take `memory` bytes of
// address space beyond its own, unless that is kNoMemoryLimit. Errors: INTERNAL, naming the step.
absl::Status LimitSelf(pid_t parent, uint64_t memory);

// From now on the process, which must have a single thread, can read and write `channel`, allocate and free memory, and
// end. Any other system call ends it with SIGSYS: to open, connect, make a process or a thread, send a signal, or map a
// file or code. Errors: UNAVAILABLE if the kernel, or the container, does not allow seccomp filters.
absl::Status ForbidSystemCalls(int channel);

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_DECODER_SANDBOX_H_
