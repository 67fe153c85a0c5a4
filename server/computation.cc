#include "server/computation.h"

#include <utility>

#include "server/errors.h"
#include "server/exceptions.h"

namespace latvox {
namespace {

// A batch leaves when it is full, or this old: someone may be watching the progress.
constexpr auto kMaxBatchAge = std::chrono::milliseconds(200);

double MillisecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

// Adds the time of a scope to `sum`.
class Stopwatch {
 public:
  explicit Stopwatch(double& sum) : sum_(sum), start_(std::chrono::steady_clock::now()) {}
  ~Stopwatch() { sum_ += MillisecondsSince(start_); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& sum_;
  const std::chrono::steady_clock::time_point start_;
};

}  // namespace

Computation::Computation(JobSpec spec, std::string request_id, MeshDecoder& decoder, const Limits& limits)
    : spec_(std::move(spec)), request_id_(std::move(request_id)), decoder_(decoder), limits_(limits) {}

absl::Status Computation::CheckCancelled() const {
  return cancelled_ ? absl::CancelledError("the request was cancelled") : absl::OkStatus();
}

void Computation::Cancel() {
  cancelled_ = true;
  // Either this sees the decode or the job, or Decode or CreateJob, which set them first, see cancelled_.
  if (VoxelizeJob* job = running_) job->Cancel();
  const std::lock_guard lock(decoding_mu_);
  if (decoding_) decoding_->Cancel();
}

void Computation::Decode(MeshUpload upload, std::function<void(const absl::Status&)> decoded) {
  mesh_bytes_ = upload.size();
  upload_ms_ = upload.milliseconds();
  decode_began_ = Clock::now();
  const std::lock_guard lock(decoding_mu_);
  decoding_ = decoder_.Start(std::move(upload).Take(), limits_,
                             [this, decoded = std::move(decoded)](absl::StatusOr<DecodedMesh> mesh) {
                               facts_.decode_ms = MillisecondsSince(decode_began_);
                               const absl::Status status = mesh.status();
                               if (mesh.ok()) decoded_ = *std::move(mesh);
                               decoded(status);
                             });
  if (cancelled_) decoding_->Cancel();
}

absl::Status Computation::CreateJob() {
  const Stopwatch stopwatch(facts_.voxelize_ms);
  DecodedMesh decoded = std::move(decoded_);
  facts_.triangles = decoded.mesh.triangles.size();
  source_ = {BoundsOf(decoded.mesh), decoded.quantization_bits};
  absl::StatusOr<Grid> grid = ResolveGrid(spec_.lattice, spec_.density, spec_.origin, source_.bounds);
  if (!grid.ok()) return WithCauseOfCore(grid.status());
  grid_ = *std::move(grid);
  auto job = VoxelizeJob::Create(std::move(decoded.mesh), *grid_, spec_.options);
  if (!job.ok()) return WithCauseOfCore(job.status());
  job_ = *std::move(job);
  running_ = job_.get();
  return CheckCancelled();
}

absl::Status Computation::Start(const Deliver& deliver) {
  return WithoutExceptions([&]() -> absl::Status {
    if (absl::Status status = CheckCancelled(); !status.ok()) return status;
    if (absl::Status status = CreateJob(); !status.ok()) return status;
    v1::VoxelizeResponse response;
    *response.mutable_accepted() = AcceptedToProto(request_id_, *grid_, job_->facts(), source_);
    deliver(std::move(response));
    last_delivery_ = paused_at_ = Clock::now();
    return absl::OkStatus();
  });
}

absl::StatusOr<bool> Computation::Advance(const Deliver& deliver) {
  return WithoutExceptions([&]() -> absl::StatusOr<bool> {
    facts_.stream_ms += MillisecondsSince(paused_at_);
    absl::StatusOr<bool> done = false;
    {
      const Stopwatch stopwatch(facts_.voxelize_ms);
      done = job_->Advance([&](TileBricks&& tile) { return TakeTile(tile, deliver); });
    }
    if (!done.ok()) return done;
    facts_.voxels = job_->totals().voxels;
    facts_.bricks = job_->totals().bricks;
    paused_at_ = Clock::now();
    if (!*done) return false;
    if (absl::Status status = DeliverSummary(deliver); !status.ok()) return status;
    return true;
  });
}

bool Computation::TakeTile(const TileBricks& tile, const Deliver& deliver) {
  if (spec_.verify) {
    for (const Brick& brick : tile.bricks) voxels_.Add(brick);
  }
  batcher_.Add(tile);
  return batcher_.full() || Clock::now() - last_delivery_ > kMaxBatchAge ? DeliverBatch(deliver) : true;
}

bool Computation::DeliverBatch(const Deliver& deliver) {
  last_delivery_ = Clock::now();
  v1::VoxelizeResponse response;
  *response.mutable_bricks() = batcher_.Take();
  return deliver(std::move(response));
}

absl::Status Computation::DeliverSummary(const Deliver& deliver) {
  if (!batcher_.empty()) DeliverBatch(deliver);
  std::optional<Verdict> verdict;
  if (spec_.verify) {
    const Stopwatch stopwatch(facts_.voxelize_ms);
    const absl::StatusOr<Verdict> verified = job_->Verify(voxels_);
    if (!verified.ok()) return verified.status();
    verdict = *verified;
  }
  const JobTotals& totals = job_->totals();
  v1::VoxelizeResponse response;
  v1::Summary& summary = *response.mutable_summary();
  summary.set_voxels(totals.voxels);
  summary.set_bricks(totals.bricks);
  summary.set_tiles(totals.tiles);
  *summary.mutable_certificate() = CertificateToProto(spec_, job_->facts(), source_, totals.digest, verdict);
  v1::Timings& timings = *summary.mutable_timings();
  timings.set_upload_ms(upload_ms_);
  timings.set_decode_ms(facts_.decode_ms);
  timings.set_voxelize_ms(facts_.voxelize_ms);
  timings.set_stream_ms(facts_.stream_ms);
  summary.set_mesh_bytes(mesh_bytes_);
  deliver(std::move(response));
  return absl::OkStatus();
}

}  // namespace latvox
