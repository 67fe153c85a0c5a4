// One place of a decoder pool: a decoder process, replaced when it ends, and its current decode.
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
  // Processes that ended during this job: killed by someone, by themselves, and because they did nothing.
  int killed = 0, crashed = 0, stuck = 0;
};

// Events since the pool was started.
struct DecoderCounters {
  std::atomic<uint64_t> decodes = 0, restarts = 0, crashes = 0, killed_for_time = 0, killed_for_memory = 0;
};

// For the pool's thread; not thread-safe, except where stated. It blocks no longer than the start of a process takes.
class DecoderSlot {
 public:
  DecoderSlot(const DecoderOptions& options, DecoderCounters& counters);

  // Whether a process waits for a job.
  bool idle() const { return state_ == State::kIdle; }
  const std::shared_ptr<DecodeJob>& job() const { return job_; }

  // The process's id; 0 if there is none. Thread-safe.
  pid_t pid() const { return pid_; }

  // The number of starts that failed in a row, and the last error.
  int failures() const { return failures_; }
  const std::string& failure() const { return failure_; }

  // Allows the first start, which waits for it if the options say `on_demand`.
  void Rouse();

  // Gives `job` to the process. Precondition: idle().
  void Begin(std::shared_ptr<DecodeJob> job);

  // Ends the job with `status`, and kills its process, because nothing else stops it.
  void Abort(const absl::Status& status);

  // Appends the events to poll for before the next Serve. Returns the latest time for it.
  void AppendPolls(std::vector<pollfd>& polls) const;
  absl::Time next_timer() const;

  // Does all that is possible now: starts a process, sends, receives, checks the process's limits, notices its end.
  // Returns a job that was lost with its process, for another process.
  std::shared_ptr<DecodeJob> Serve();

 private:
  enum class State {
    kEmpty,     // the next process starts at start_at_
    kStarting,  // until the process says that it is ready
    kIdle,
    kBusy,
    kEnding,  // killed, or has closed its socket
  };

  void StartProcess();
  void Fail(std::string why);
  void Send();
  void Receive();
  bool HandleFrames();
  bool HandleFrame(FrameKind kind, absl::string_view frame);
  bool HandleDeclaration(absl::string_view frame);
  void SetLimits(absl::Duration cpu_time);
  void CheckTimes();
  void GiveUp(bool used_up);
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
  bool ready_ = false, killed_ = false;  // the process has said so; this slot has killed it
  bool stuck_ = false;                   // killed, because it did nothing
  uint64_t idle_bytes_ = 0;              // of address space of the idle process
  absl::Time start_at_;
  absl::Time give_up_at_ =
      absl::InfiniteFuture();  // end of patience with a process that neither gets ready nor ends its job
  int failures_ = 0, started_ = 0;
  std::string failure_;

  std::shared_ptr<DecodeJob> job_;
  absl::Cord unsent_;
  std::optional<MeshReceiver> receiver_;
  bool declared_ = false;  // the limits below follow the mesh's declaration
  uint64_t memory_limit_ = 0;
  absl::Duration cpu_limit_;
  absl::Duration cpu_at_begin_;
  absl::Time check_cpu_at_ = absl::InfiniteFuture();

  std::vector<uint32_t> buffer_;  // words, because frames are aligned to them
  size_t received_ = 0;           // bytes in buffer_
};

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_DECODER_SLOT_H_
