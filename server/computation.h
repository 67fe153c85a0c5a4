// One request's work after its upload: encoded mesh in, response messages out. Knows no gRPC.
//
//   Decode ──▶ (elsewhere) ──▶ decoded ──▶ Start ──▶ Advance ──▶ Advance …
#ifndef LATVOX_SERVER_COMPUTATION_H_
#define LATVOX_SERVER_COMPUTATION_H_

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/voxelizer/voxelizer.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/brick_batch.h"
#include "server/convert.h"
#include "server/mesh_decoder.h"
#include "server/mesh_upload.h"

namespace latvox {

// What a computation has come to so far.
struct ComputationFacts {
  uint64_t triangles = 0, voxels = 0, bricks = 0;
  double decode_ms = 0, voxelize_ms = 0;
  double stream_ms = 0;  // paused, waiting for the client
};

// Threads: one step after the other; Cancel at any time, too.
class Computation {
 public:
  // Takes a finished message; returns false to pause.
  using Deliver = std::function<bool(v1::VoxelizeResponse&&)>;

  // `decoder` and `limits` must outlive the computation.
  Computation(JobSpec spec, std::string request_id, MeshDecoder& decoder, const Limits& limits);

  // Has the mesh decoded, and returns at once. `decoded` is called exactly once, as MeshDecoder::Done; the computation
  // has to live until then. Errors: as there.
  void Decode(MeshUpload upload, std::function<void(const absl::Status&)> decoded);

  // Delivers Accepted. Once, after a decode that went well. Errors: as the contract; CANCELLED after Cancel.
  absl::Status Start(const Deliver& deliver);

  // Delivers further BrickBatches until paused (false), or to the end, with Summary as the last message (true).
  // Errors: CANCELLED after Cancel, INTERNAL, RESOURCE_EXHAUSTED if memory runs out.
  absl::StatusOr<bool> Advance(const Deliver& deliver);

  // Makes the step under way end soon.
  void Cancel();

  const JobSpec& spec() const { return spec_; }
  // Not while a step is under way.
  const ComputationFacts& facts() const { return facts_; }

 private:
  using Clock = std::chrono::steady_clock;

  absl::Status CheckCancelled() const;
  absl::Status CreateJob();
  bool TakeTile(const TileBricks& tile, const Deliver& deliver);
  bool DeliverBatch(const Deliver& deliver);
  absl::Status DeliverSummary(const Deliver& deliver);

  const JobSpec spec_;
  const std::string request_id_;
  MeshDecoder& decoder_;
  const Limits& limits_;

  std::atomic<bool> cancelled_ = false;
  std::mutex decoding_mu_;
  std::shared_ptr<MeshDecoder::Decoding> decoding_;  // for Cancel; guarded by decoding_mu_
  std::atomic<VoxelizeJob*> running_ = nullptr;      // job_, for Cancel
  Clock::time_point decode_began_;
  DecodedMesh decoded_;  // until Start
  std::unique_ptr<VoxelizeJob> job_;
  std::optional<Grid> grid_;
  MeshSource source_;
  VoxelSet voxels_;  // of the whole result, if it is to be verified
  BrickBatcher batcher_;
  uint64_t mesh_bytes_ = 0;
  double upload_ms_ = 0;
  Clock::time_point last_delivery_, paused_at_;
  ComputationFacts facts_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_COMPUTATION_H_
