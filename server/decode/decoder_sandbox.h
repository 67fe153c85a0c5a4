// Confinement of a decoder process.
#ifndef LATVOX_SERVER_DECODE_DECODER_SANDBOX_H_
#define LATVOX_SERVER_DECODE_DECODER_SANDBOX_H_

#include <sys/types.h>

#include <cstdint>

#include "absl/status/status.h"

namespace latvox {

// AddressSanitizer takes address space by the terabyte, needs files, and asks the system for more than malloc. A build
// with it, which is for tests, does not confine its decoders.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kAddressSanitizer = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool kAddressSanitizer = true;
#else
inline constexpr bool kAddressSanitizer = false;
#endif
#else
inline constexpr bool kAddressSanitizer = false;
#endif

// Makes the process end with the process `parent`, keeps it from leaving a core, from being traced, from gaining
// privileges and from opening or growing files, and has the kernel, short of memory, kill it before others. It may take
// `memory` bytes of address space beyond what it has, unless that is kNoMemoryLimit. Errors: INTERNAL, naming the step.
absl::Status LimitSelf(pid_t parent, uint64_t memory);

// From now on the process, which must have one thread only, can read and write `channel`, take and give back memory,
// and end. Any other system call ends it with SIGSYS: to open, connect, make a process or a thread, send a signal, or
// map a file or code. Errors: UNAVAILABLE if the kernel, or the container, does not allow seccomp filters.
absl::Status ForbidSystemCalls(int channel);

// Bytes of address space in use. 0 if /proc cannot tell.
uint64_t AddressSpaceInUse();

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_DECODER_SANDBOX_H_
