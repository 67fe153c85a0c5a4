// One place of a decoder pool: a decoder process, and again another when that has ended, and the decode it is busy
// with.
#ifndef LATVOX_SERVER_DECODE_DECODER_SLOT_H_
#define LATVOX_SERVER_DECODE_DECODER_SLOT_H_

#include <poll.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/cord.h"
#include "absl/time/time.h"
#include "server/decode/decoder_process.h"
#include "server/decode/decoder_protocol.h"
#include "server/decode/mesh_decoder.h"

namespace latvox {

struct DecodeJob {
  EncodedMesh mesh;
  Limits limits;
  MeshDecoder::Reserve reserve;
  MeshDecoder::Done done;
  bool is_large = false;  // takes some 50 ms or more
  // Processes that ended while they had this job: by someone, and by themselves.
  int killed = 0, crashed = 0;
};

// Events since the pool was started.
struct DecoderCounters {
  std::atomic<uint64_t> decodes = 0, restarts = 0, crashes = 0, killed_for_time = 0, killed_for_memory = 0;
};

// Not thread-safe, but for what says so: for the pool's thread. Never blocks for longer than it takes to start a
// process.
class DecoderSlot {
 public:
  DecoderSlot(const DecoderOptions& options, DecoderCounters& counters);

  // Whether there is a process that waits for a job.
  bool idle() const { return state_ == State::kIdle; }
  const std::shared_ptr<DecodeJob>& job() const { return job_; }

  // Of the process; 0 if there is none. Thread-safe.
  pid_t pid() const { return pid_; }

  // How often in a row a process could not be started, and why.
  int failures() const { return failures_; }
  const std::string& failure() const { return failure_; }

  // Hands `job` to the process. Precondition: idle().
  void Begin(std::shared_ptr<DecodeJob> job);

  // Ends the job with `status`, and its process, which has no other way to stop.
  void Abort(const absl::Status& status);

  // What to poll for before the next Serve, and until when at the latest.
  void AppendPolls(std::vector<pollfd>& polls) const;
  absl::Time next_timer() const;

  // Does what can be done now: starts a process, sends, receives, holds the process against its limits, notices its
  // end. Returns a job that was lost with its process, to be done again by another.
  std::shared_ptr<DecodeJob> Serve();

 private:
  enum class State {
    kEmpty,     // a process is started at start_at_
    kStarting,  // until it says that it is ready
    kIdle,
    kBusy,
    kEnding,  // killed, or has hung up
  };

  void StartProcess();
  void Fail(std::string why);
  void Send();
  void Receive();
  bool HandleFrames();
  bool HandleFrame(FrameKind kind, absl::string_view frame);
  void CheckTimes();
  std::shared_ptr<DecodeJob> HandleEnd(const ProcessEnd& end);
  std::shared_ptr<DecodeJob> HandleLostJob(bool crashed);
  void Finish(absl::StatusOr<DecodedMesh> result);
  void Kill();
  void LogTrouble(absl::string_view event, const std::string& end = "") const;

  const DecoderOptions& options_;
  DecoderCounters& counters_;

  State state_ = State::kEmpty;
  std::unique_ptr<DecoderProcess> process_;
  std::atomic<pid_t> pid_ = 0;           // for pid()
  bool ready_ = false, killed_ = false;  // the process has said so; this has killed it
  uint64_t idle_bytes_ = 0;              // of the process's address space
  absl::Time start_at_ = absl::InfinitePast();
  absl::Time give_up_at_ = absl::InfiniteFuture();  // on a process that neither gets ready nor ends its job
  int failures_ = 0, started_ = 0;
  std::string failure_;

  std::shared_ptr<DecodeJob> job_;
  absl::Cord unsent_;
  std::optional<MeshReceiver> receiver_;
  uint64_t memory_limit_ = 0;
  absl::Duration cpu_at_begin_;
  absl::Time check_cpu_at_ = absl::InfiniteFuture();

  std::vector<uint32_t> buffer_;  // words, for frames are aligned to them
  size_t received_ = 0;           // bytes in buffer_
};

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_DECODER_SLOT_H_
