// The rights of a process that reads a foreign file.
#ifndef LATVOX_CLIENT_TOOL_CONFINED_READER_SANDBOX_H_
#define LATVOX_CLIENT_TOOL_CONFINED_READER_SANDBOX_H_

#include <sys/types.h>

#include "absl/status/status.h"
#include "client/tool/confined/reader_process.h"

namespace latvox::client {

// AddressSanitizer takes terabytes of address space, and more system calls. A build with it, for tests, limits only the
// time.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kAddressSanitizer = true;
#elif defined(__has_feature)
inline constexpr bool kAddressSanitizer = __has_feature(address_sanitizer);
#else
inline constexpr bool kAddressSanitizer = false;
#endif

// Ties this process to `parent`, so that it never outlives it, and sets the limits. From now on, it can read
// kReaderFile, write to kReaderChannel, allocate memory and end. All other system calls fail, and none of them opens,
// connects or starts anything. Where the kernel, or a container, has no seccomp filters, the limits alone hold: no
// memory and time beyond them, no growing file, no new file descriptor. Errors: INTERNAL, naming the step.
absl::Status ConfineReader(pid_t parent, const ReaderLimits& limits);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CONFINED_READER_SANDBOX_H_
