// A process that reads a foreign file, as its parent sees it.
#ifndef LATVOX_CLIENT_TOOL_CONFINED_READER_PROCESS_H_
#define LATVOX_CLIENT_TOOL_CONFINED_READER_PROCESS_H_

#include <sys/types.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// The first argument of such a process, and its open files besides three that lead nowhere.
inline constexpr char kReaderArgument[] = "--read-foreign-file";
inline constexpr int kReaderFile = 3, kReaderChannel = 4;

// Its exit statuses.
inline constexpr int kReaderDone = 0;          // a result or an error was sent
inline constexpr int kReaderMisused = 1;       // its arguments are none
inline constexpr int kReaderLacksLibrary = 2;  // Vdb::Load fails
inline constexpr int kReaderOutOfMemory = 77;  // beyond ReaderLimits
inline constexpr int kReaderCannotSend = 100;  // and errno, which is below 156 on Linux

// The most that a file may cost. A whole file takes far less: OpenVDB unpacks up to 45 bytes from one, and reads some
// megabytes a second on a slow disk of a busy machine.
struct ReaderLimits {
  uint64_t memory = 0;   // bytes beyond those of a process that has read nothing
  uint64_t seconds = 0;  // of processor time
};
ReaderLimits ReaderLimitsFor(uint64_t file_bytes);

// A child of this process, which ends with it. Not thread-safe.
class ReaderProcess {
 public:
  // Starts the program of ProgramPath, whose main() must ask IsReader, for a regular file. `what` and `path` are its
  // arguments. Errors: NOT_FOUND; INVALID_ARGUMENT (no regular file, not readable), with the path; RESOURCE_EXHAUSTED
  // (no process).
  static absl::StatusOr<std::unique_ptr<ReaderProcess>> Start(const std::string& path, const std::string& what,
                                                              const Cancellation& cancellation);
  ~ReaderProcess();  // kills it
  ReaderProcess(const ReaderProcess&) = delete;
  ReaderProcess& operator=(const ReaderProcess&) = delete;

  // Waits for this many bytes. Errors: DATA_LOSS: it has ended before, or has sent more than limits().memory bytes;
  // CANCELLED.
  absl::Status Receive(void* to, size_t bytes);

  // Kills the process, and returns INVALID_ARGUMENT with the path: that the file is damaged, and how the process ended.
  // RESOURCE_EXHAUSTED if the system had too little memory for it. The error of Vdb::Load if it had no OpenVDB.
  absl::Status Blame();

  const ReaderLimits& limits() const { return limits_; }
  const std::string& path() const { return path_; }

 private:
  ReaderProcess(const std::string& path, ReaderLimits limits, pid_t pid, int channel, const Cancellation& cancellation)
      : path_(path), limits_(limits), pid_(pid), channel_(channel), cancellation_(cancellation) {}

  absl::Status Damaged(const std::string& why) const;
  absl::Status BlameEnd(int code, int status) const;

  const std::string path_;
  const ReaderLimits limits_;
  pid_t pid_;  // 0: it has ended
  const int channel_;
  const Cancellation cancellation_;
  uint64_t received_ = 0;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CONFINED_READER_PROCESS_H_
