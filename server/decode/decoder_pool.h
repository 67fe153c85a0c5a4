// Draco in processes of their own, which can do nothing but decode.
//
// What a hostile file can do to one: use up its memory or its time, or take it over. Then it ends, and its decode with
// an error; or it sends a mesh that the file does not hold, for this request or, as a process serves many and meshes
// are kept, for later ones. It can not reach files, the network, other processes or the server's memory.
#ifndef LATVOX_SERVER_DECODE_DECODER_POOL_H_
#define LATVOX_SERVER_DECODE_DECODER_POOL_H_

#include <cstdint>
#include <deque>
#include <future>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "server/decode/decoder_process.h"
#include "server/decode/decoder_slot.h"
#include "server/decode/mesh_decoder.h"

namespace latvox {

struct DecoderFacts {
  int processes = 0;               // that the pool has, whether they live just now or not
  uint64_t decodes = 0;            // ended, well or not
  uint64_t restarts = 0;           // of processes, for whatever reason; a cancelled decode is one
  uint64_t crashes = 0;            // of processes, with a decode under way
  uint64_t killed_for_time = 0;    // processes, by the pool
  uint64_t killed_for_memory = 0;  // processes that came to the end of their memory
  double memory_bytes = 0;         // that the processes hold just now
  double most_memory_bytes = 0;    // that decodes in all of them may take
};

// Decodes wait in order for a process that is free. Those of large meshes never take all processes, if there are two or
// more, so that small ones do not wait for them.
class DecoderPool final : public MeshDecoder {
 public:
  // Starts the processes, and waits for the first of them. Errors: INVALID_ARGUMENT (no program, process or memory),
  // UNAVAILABLE if processes cannot be started, or not be confined, here.
  static absl::StatusOr<std::unique_ptr<DecoderPool>> Create(const DecoderOptions& options);

  // Cancels what is under way. No process is left when it returns.
  ~DecoderPool() override;

  // What is lost with its process is done again by another: a mesh that two crash on is bad. Errors, besides those of
  // MeshDecoder: RESOURCE_EXHAUSTED with a retry delay if five were killed by someone else; UNAVAILABLE with one if no
  // process can be started.
  std::shared_ptr<Decoding> Start(EncodedMesh mesh, const Limits& limits, Reserve reserve, Done done) override;

  // Not while the pool is being destroyed.
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
  bool MayBegin(const DecodeJob& job) const;
  void EndQueued(const absl::Status& status);

  const DecoderOptions options_;
  const int wake_;  // eventfd

  // The thread's, but for the slots' process ids; there are the same slots until the end.
  DecoderCounters counters_;
  std::vector<std::unique_ptr<DecoderSlot>> slots_;
  std::deque<std::shared_ptr<DecodeJob>> queue_;
  std::promise<absl::Status> first_;  // a slot's: that its process is ready, or why not
  bool first_is_known_ = false;

  std::mutex mu_;
  // All below is guarded by mu_.
  std::vector<std::shared_ptr<DecodeJob>> added_, cancelled_;
  bool stopping_ = false;

  std::thread thread_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_DECODER_POOL_H_
