// A decoder process, seen from the server.
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

// How to start decoder processes, and the limits of a decode.
struct DecoderOptions {
  std::string program;  // latvoxd; there is no default, because another program could be started in its place
  int processes = 0;    // 0: the server chooses; a pool needs at least one
  uint64_t memory = 0;  // bytes for the decode of one mesh, as below; 0: the server chooses; a pool needs some
  absl::Duration cpu_time = absl::Seconds(10);
  bool on_demand = false;  // start processes with the first decode, because there may be none
  bool may_be_unconfined =
      false;  // start without seccomp filters where the system does not allow them; otherwise there is no decoder there
};

// The most memory that Draco takes for a triangle of a mesh with positions only, besides the encoded mesh. Measured: 67
// to 76 for edgebreaker, 30 to 35 for sequential. Memory counts as address space beyond that of an idle process.
inline constexpr uint64_t kDecoderBytesPerTriangle = 80;

// DecoderOptions::memory for builds with a sanitizer, because its own use of address space would count.
inline constexpr uint64_t kNoMemoryLimit = UINT64_MAX;

// The way in which a process has ended.
struct ProcessEnd {
  bool by_signal = false;
  int status = 0;  // exit status or signal

  // Whether the program failed, by itself or by the kernel's judgment, and was not ended by someone.
  bool is_crash() const;
  std::string ToString() const;
};

// Not thread-safe. The process ends no later than the thread that started it.
class DecoderProcess {
 public:
  // Errors: INTERNAL, naming the step that the system refuses.
  static absl::StatusOr<std::unique_ptr<DecoderProcess>> Start(const DecoderOptions& options);

  // Kills the process, unless it has ended, and waits for its end.
  ~DecoderProcess();
  DecoderProcess(const DecoderProcess&) = delete;
  DecoderProcess& operator=(const DecoderProcess&) = delete;

  pid_t pid() const { return pid_; }
  // The socket to the process; non-blocking.
  int channel() const { return channel_; }
  // Readable once the process has ended.
  int end() const { return pidfd_; }

  void Kill();

  // Returns the way in which it has ended; nothing if it has not. Gives its process id back to the system.
  std::optional<ProcessEnd> ReceiveEnd();

  // The CPU time that it has used so far.
  absl::Duration CpuTime() const;

  // Sets the limit of its address space, at most that of its start. The process itself has no call for that.
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
