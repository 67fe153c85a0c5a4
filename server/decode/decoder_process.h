// A decoder process, from outside.
#ifndef LATVOX_SERVER_DECODE_DECODER_PROCESS_H_
#define LATVOX_SERVER_DECODE_DECODER_PROCESS_H_

#include <sys/types.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace latvox {

// How decoder processes are started, and what a decode in one may take.
struct DecoderOptions {
  std::string program;  // latvoxd; there is no default, for a program that is not would be started in its place
  int processes = 0;    // 0: the server's choice; a pool needs some
  uint64_t memory = 0;  // bytes that decoding one mesh may take, as below. 0: the server's choice; a pool needs some
  absl::Duration cpu_time = absl::Seconds(10);
  bool may_be_unconfined = false;  // where the system does not allow seccomp filters; else there is no decoder there
};

// What Draco takes at most for a triangle of a mesh with positions only, beside the encoded mesh: measured for
// edgebreaker 67 to 76, for sequential 30 to 35. Memory is counted as address space beyond that of an idle process.
inline constexpr uint64_t kDecoderBytesPerTriangle = 80;

// DecoderOptions::memory for builds with AddressSanitizer, whose own use of address space would count.
inline constexpr uint64_t kNoMemoryLimit = UINT64_MAX;

// How a process has ended.
struct ProcessEnd {
  bool by_signal = false;
  int status = 0;  // exit status or signal

  // The end of a program that fails, by itself or by the kernel's judgement, as opposed to one that someone ends.
  bool is_crash() const;
  std::string ToString() const;
};

// Not thread-safe. The process ends with the thread that started it, at the latest.
class DecoderProcess {
 public:
  // Errors: INTERNAL, naming what the system refuses.
  static absl::StatusOr<std::unique_ptr<DecoderProcess>> Start(const DecoderOptions& options);

  // Kills the process, if it has not ended, and waits for its end.
  ~DecoderProcess();
  DecoderProcess(const DecoderProcess&) = delete;
  DecoderProcess& operator=(const DecoderProcess&) = delete;

  pid_t pid() const { return pid_; }
  // The socket to it; non-blocking.
  int channel() const { return channel_; }
  // Readable once the process has ended.
  int end() const { return pidfd_; }

  void Kill();

  // How it has ended; nothing if it has not. Gives its process id back to the system.
  std::optional<ProcessEnd> ReceiveEnd();

  // CPU time it has used so far.
  absl::Duration CpuTime() const;

  // Lowers or raises what it may take, within what it was started with. The process has no call for that.
  void LimitAddressSpace(uint64_t bytes);

 private:
  DecoderProcess(pid_t pid, int channel, int pidfd) : pid_(pid), channel_(channel), pidfd_(pidfd) {}

  std::optional<ProcessEnd> ReceiveEnd(int options);

  const pid_t pid_;
  const int channel_, pidfd_;
  bool ended_ = false;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_DECODER_PROCESS_H_
