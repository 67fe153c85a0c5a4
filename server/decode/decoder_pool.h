// Draco in processes of their own, which can do nothing except decode.
//
// A hostile file can use up a process's memory or time, or take the process over. In the first case, the process and
// its decode end with an error. In the second case, the process may send a mesh that the file does not hold: for this
// request, or for later ones, because a process serves many requests and meshes are kept. It cannot reach files, the
// network, other processes or the server's memory.
#ifndef LATVOX_SERVER_DECODE_DECODER_POOL_H_
#define LATVOX_SERVER_DECODE_DECODER_POOL_H_

#include <cstdint>
#include <deque>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/decode/decoder_process.h"
#include "server/decode/decoder_slot.h"
#include "server/decode/mesh_decoder.h"

namespace latvox {

struct DecoderFacts {
  int processes = 0;               // in the pool, whether they live at the moment or not
  uint64_t decodes = 0;            // ended, with or without success
  uint64_t restarts = 0;           // of processes, for any reason; a cancelled decode causes one
  uint64_t crashes = 0;            // of processes during a decode
  uint64_t killed_for_time = 0;    // processes that the pool killed
  uint64_t killed_for_memory = 0;  // processes that used up their memory
  double memory_bytes = 0;         // that the processes hold at the moment
  double most_memory_bytes = 0;    // that decodes in all processes may take
};

// Decodes wait for a free process, and clients have turns. The client with the fewest decodes at work is the next. If
// several have the fewest, the one that has waited longest since its last turn is the next. Decodes of large meshes
// never occupy all processes, unless there is only one: small decodes do not wait for them.
class DecoderPool final : public MeshDecoder {
 public:
  // Starts the processes, and waits for the first of them, unless they start on demand. Errors: INVALID_ARGUMENT (no
  // program, process or memory); UNAVAILABLE if processes cannot be started or confined here.
  static absl::StatusOr<std::unique_ptr<DecoderPool>> Create(const DecoderOptions& options);

  // Cancels decodes under way. No process is left when it returns.
  ~DecoderPool() override;

  // A decode that is lost with its process is repeated in another process. A mesh that crashes two processes is bad.
  // Errors besides those of MeshDecoder: RESOURCE_EXHAUSTED with a retry delay if someone else killed five processes;
  // UNAVAILABLE with a retry delay if no process can be started.
  std::shared_ptr<Decoding> Start(EncodedMesh mesh, const Limits& limits, Reserve reserve, Done done) override;

  // Do not call it while the pool is being destroyed.
  DecoderFacts facts() const;

 private:
  class PooledDecode;

  explicit DecoderPool(const DecoderOptions& options);

  void Cancel(std::shared_ptr<DecodeJob> job);
  void Wake();
  void Run();
  void Wait();
  bool HandleInbox();
  void CancelNow(const std::shared_ptr<DecodeJob>& job);
  void ReportFirst();
  void Assign();
  std::shared_ptr<DecodeJob> ReleaseNext();
  bool MayBegin(const DecodeJob& job) const;
  void EndQueued(const absl::Status& status);

  const DecoderOptions options_;
  const int wake_;  // eventfd

  // Owned by the thread, except the slots' process ids. The slots stay the same until the end.
  DecoderCounters counters_;
  std::vector<std::unique_ptr<DecoderSlot>> slots_;
  std::deque<std::shared_ptr<DecodeJob>> queue_;
  std::map<std::string, uint64_t> last_turns_;  // of clients in the queue, and of those with a decode at work
  uint64_t turns_ = 0;
  std::promise<absl::Status> first_;  // set by a slot: its process is ready, or the reason why not
  bool first_is_known_ = false;

  std::mutex mu_;
  // All below is guarded by mu_.
  std::vector<std::shared_ptr<DecodeJob>> added_, cancelled_;
  bool stopping_ = false;

  std::thread thread_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_DECODER_POOL_H_
