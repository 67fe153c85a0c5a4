#include "server/computation.h"

#include <utility>

#include "server/errors.h"
#include "server/exceptions.h"

namespace latvox {
namespace {

// A batch leaves when it is full, or this old: someone may be watching the progress.
constexpr auto kMaxBatchAge = std::chrono::milliseconds(200);

// Adds the time of a scope to `sum`.
class Stopwatch {
 public:
  explicit Stopwatch(double& sum) : sum_(sum), start_(std::chrono::steady_clock::now()) {}
  ~Stopwatch() { sum_ += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count(); }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double& sum_;
  const std::chrono::steady_clock::time_point start_;
};

}  // namespace

Computation::Computation(JobSpec spec, std::string request_id, const MeshDecoder& decoder, const Limits& limits)
    : spec_(std::move(spec)),
      request_id_(std::move(request_id)),
      decoder_(decoder),
      limits_(limits),
      batcher_(spec_.encoding) {}

absl::Status Computation::CheckCancelled() const {
  return cancelled_ ? absl::CancelledError("the request was cancelled") : absl::OkStatus();
}

void Computation::Cancel() {
  cancelled_ = true;
  // Either this sees the job, or CreateJob, which sets running_ first, sees cancelled_.
  if (VoxelizeJob* job = running_) job->Cancel();
}

absl::Status Computation::CreateJob(MeshUpload upload) {
  mesh_bytes_ = upload.size();
  upload_ms_ = upload.milliseconds();
  absl::StatusOr<DecodedMesh> decoded;
  {
    const Stopwatch stopwatch(facts_.decode_ms);
    decoded = decoder_.Decode(std::move(upload).Join(), limits_);
  }
  if (!decoded.ok()) return decoded.status();
  if (absl::Status status = CheckCancelled(); !status.ok()) return status;

  const Stopwatch stopwatch(facts_.voxelize_ms);
  facts_.triangles = decoded->mesh.triangles.size();
  source_ = {BoundsOf(decoded->mesh), decoded->quantization_bits};
  absl::StatusOr<Grid> grid = ResolveGrid(spec_.lattice, spec_.density, spec_.origin, source_.bounds);
  if (!grid.ok()) return WithCauseOfCore(grid.status());
  grid_ = *std::move(grid);
  auto job = VoxelizeJob::Create(std::move(decoded->mesh), *grid_, spec_.options);
  if (!job.ok()) return WithCauseOfCore(job.status());
  job_ = *std::move(job);
  running_ = job_.get();
  return CheckCancelled();
}

absl::Status Computation::Start(MeshUpload upload, const Deliver& deliver) {
  return WithoutExceptions([&]() -> absl::Status {
    if (absl::Status status = CheckCancelled(); !status.ok()) return status;
    if (absl::Status status = CreateJob(std::move(upload)); !status.ok()) return status;
    v1::VoxelizeResponse response;
    *response.mutable_accepted() = AcceptedToProto(request_id_, *grid_, job_->facts(), source_);
    deliver(std::move(response));
    last_delivery_ = paused_at_ = Clock::now();
    return absl::OkStatus();
  });
}

absl::StatusOr<bool> Computation::Advance(const Deliver& deliver) {
  return WithoutExceptions([&]() -> absl::StatusOr<bool> {
    facts_.stream_ms += std::chrono::duration<double, std::milli>(Clock::now() - paused_at_).count();
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
