// One request's work after its upload: encoded mesh in, response messages out. It does not know gRPC.
//
//   Receive … ──▶ ReceiveMesh ──▶ Decode ──▶ (elsewhere) ──▶ decoded ──▶ Measure ──▶ Start ──▶ Advance ──▶ Advance …
#ifndef LATVOX_SERVER_WORK_COMPUTATION_H_
#define LATVOX_SERVER_WORK_COMPUTATION_H_

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/cpu_meter.h"
#include "core/base/stop_signal.h"
#include "core/voxelizer/voxelizer.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/decode/mesh_decoder.h"
#include "server/decode/mesh_store.h"
#include "server/wire/answers.h"
#include "server/wire/brick_batch.h"
#include "server/wire/convert.h"
#include "server/work/call_environment.h"
#include "server/work/job_memory.h"
#include "server/work/mesh_upload.h"

namespace latvox {

// The results and times of a computation so far.
struct ComputationFacts {
  uint64_t triangles = 0, voxels = 0, bricks = 0;
  uint64_t reserved_bytes = 0;          // of memory, at most
  double estimated_ms = 0, cpu_ms = 0;  // of CPU time: before the job began, and at its end
  double decode_ms = 0, voxelize_ms = 0;
  double stream_ms = 0;  // pauses: the wait for the client, then for a turn
};

// Threads: one step after the other; Cancel and Oversee at any time.
class Computation {
 public:
  // Takes a finished message; returns false to pause.
  using Deliver = std::function<bool(v1::VoxelizeResponse&&)>;

  Computation(JobSpec spec, std::string request_id, const CallEnvironment& environment);

  // Reserves memory for an upload of so many bytes in all. Cheap enough for a gRPC callback. Errors: as
  // JobMemory::ReserveUpload.
  absl::Status Receive(uint64_t bytes);

  // Checks the digest of the uploaded mesh, if the request has one, and stores the mesh. Without an upload, finds the
  // stored mesh. Call it once. Errors: INVALID_ARGUMENT; NOT_FOUND if no such mesh is stored.
  absl::Status ReceiveMesh(MeshUpload upload);

  // Returns the length of the encoded mesh. Call it after ReceiveMesh.
  uint64_t mesh_bytes() const { return mesh_bytes_; }

  // Decodes plain arrays, or finds the stored mesh. Returns nullopt if the mesh needs Decode. May copy the whole mesh.
  // Errors: as MeshDecoder::Done.
  std::optional<absl::Status> DecodeAtOnce();

  // Starts to decode the mesh, and returns at once. Calls `decoded` exactly once, like MeshDecoder::Done; the
  // computation must live until then. Call it once, after DecodeAtOnce. Errors: as MeshDecoder::Done.
  void Decode(std::function<void(const absl::Status&)> decoded);

  // Whether the next steps will take long: by the estimate, or because the earlier ones did. Call it after a successful
  // decode.
  bool IsLarge() const { return large_; }

  // Whether the whole job takes some tenths of a millisecond, by the estimate and by its time so far. Call it after a
  // successful decode.
  bool IsTiny() const;

  // Finds the grid, and estimates the job. Call it once, after a successful decode. Errors: as the contract; CANCELLED
  // after Cancel.
  absl::Status Measure();

  // Delivers Accepted. Call it once, after Measure. Errors: as the contract; CANCELLED after Cancel.
  absl::Status Start(const Deliver& deliver);

  // Delivers further BrickBatches until paused (false), or to the end, with Summary as the last message (true). Pauses
  // after some milliseconds if `make_way` says that others wait, and when the job becomes large. Errors: CANCELLED
  // after Cancel, INTERNAL, RESOURCE_EXHAUSTED if memory runs out.
  absl::StatusOr<bool> Advance(const Deliver& deliver, const std::function<bool()>& make_way);

  // Gives all memory back, but keeps facts(). Call it when no step and no Cancel runs or follows.
  void Free();

  // Ends the current step soon.
  void Cancel();

  // Call it every few milliseconds. Ends an Advance soon, even in the middle of a tile, once it takes longer than a
  // small job. Errors: RESOURCE_EXHAUSTED if the job has used up its CPU time.
  absl::Status Oversee();

  const JobSpec& spec() const { return spec_; }
  // Not during a step.
  const ComputationFacts& facts() const { return facts_; }

 private:
  using Clock = std::chrono::steady_clock;

  absl::Status CheckCancelled() const;
  MeshReading reading() const;
  bool FindDecoded();
  absl::Status ReadRaw(const RawMeshLayout& layout);
  absl::Status ReceiveDecoded(absl::StatusOr<DecodedMesh> mesh);
  absl::Status ReserveForJob(const TriangleMesh& mesh);
  void ShareIfItComesAgain();
  const DecodedMesh& mesh_of_job() const { return kept_ ? *kept_ : decoded_; }
  JobEstimate EstimateJob(const TriangleMesh& mesh, double voxels) const;
  bool VerifiesLong() const;
  absl::Status CheckVisits(absl::string_view what, double visits) const;
  absl::Status CreateJob();
  bool HandleTile(TileBricks tile, const Deliver& deliver);
  bool AddToBatch(TileBricks tile, const Deliver& deliver);
  bool DeliversTheEndOnly() const;
  const JobTotals& totals() const;
  absl::Status KeepForVerification(const TileBricks& tile);
  bool DeliverBatch(const Deliver& deliver, bool tile_continues = false);
  absl::Status DeliverSummary(const Deliver& deliver);

  const JobSpec spec_;
  const std::string request_id_;
  const CallEnvironment environment_;
  JobMemory memory_;

  StopSource stop_;
  std::mutex decoding_mu_;
  std::shared_ptr<MeshDecoder::Decoding> decoding_;  // for Cancel; guarded by decoding_mu_
  std::atomic<VoxelizeJob*> running_ = nullptr;      // job_, for Cancel and Oversee
  std::atomic<Clock::rep> small_since_ = 0;          // when Advance of a small job began; 0: none runs
  CpuMeter cpu_;                                     // of the steps before the job exists
  Clock::time_point decode_began_;
  absl::Cord mesh_;                          // encoded, until it is decoded
  bool mesh_comes_again_ = false;            // it was stored before this request
  std::shared_ptr<const DecodedMesh> kept_;  // until Start, if the store has the mesh
  DecodedMesh decoded_;                      // until Start, if the store does not have it
  bool large_ = false;
  double visits_ = 0;  // estimated
  JobEstimate estimate_;
  std::unique_ptr<VoxelizeJob> job_;
  std::optional<Grid> grid_;
  MeshSource source_;
  VoxelSet voxels_;       // the whole result, for verification
  JobTotals delivered_;   // totals of the delivered end, where all is verified but only the end is wanted
  absl::Status failure_;  // of the sink
  BrickBatcher batcher_;
  uint64_t mesh_bytes_ = 0;
  double upload_ms_ = 0;
  Clock::time_point last_delivery_, paused_at_;
  ComputationFacts facts_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_WORK_COMPUTATION_H_
