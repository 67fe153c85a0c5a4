#include "server/work/computation.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/brick/tile_order.h"
#include "core/voxelizer/estimate.h"
#include "core/voxelizer/walk_estimate.h"
#include "server/base/errors.h"
#include "server/base/exceptions.h"
#include "server/base/milliseconds.h"
#include "server/work/work_lanes.h"

namespace latvox {
namespace {

// A batch leaves when it is full, or this old, because someone may be watching the progress.
constexpr auto kMaxBatchAge = std::chrono::milliseconds(200);

// The longest time that a computation runs while others wait.
constexpr auto kSlice = std::chrono::milliseconds(20);

constexpr double kLongMilliseconds = 50;

// By the estimate. On a loaded core, such a job may take a few times as long.
constexpr double kTinyMilliseconds = 0.5;
constexpr double kMostTinyMilliseconds = 2;

absl::Status BadResumePoint(const Vec3i& tile_ijk) {
  const std::string tile = absl::StrJoin(tile_ijk, ",");
  return BadSpec(absl::StrCat("resume_after: tile ", tile, " does not meet the index box"), "resume_after", tile);
}

absl::Status UnknownMesh() {
  return MakeError(absl::StatusCode::kNotFound, "mesh_sha256: the server does not have this mesh",
                   {kMeshNotFound, "mesh_sha256", "", ""});
}

// Returns the number of float vertices that take as much memory as this many doubles: twice the size, and no rounding
// in place.
uint64_t AsFloats(uint64_t doubles) { return 3 * doubles; }

}  // namespace

Computation::Computation(JobSpec spec, std::string request_id, const CallEnvironment& environment)
    : spec_(std::move(spec)),
      request_id_(std::move(request_id)),
      environment_(environment),
      memory_(spec_.request, environment.bulk.threads(), environment.memory, environment.client),
      batcher_(spec_.encoding) {}

absl::Status Computation::CheckCancelled() const {
  return stop_.Stopped() ? absl::CancelledError("the request was cancelled") : absl::OkStatus();
}

void Computation::Cancel() {
  stop_.Stop();
  // Decode and CreateJob set decoding_ and running_ before they read stop_. So either this function sees the decode or
  // the job, or they see stop_.
  if (VoxelizeJob* job = running_) job->Cancel();
  const std::lock_guard lock(decoding_mu_);
  if (decoding_) decoding_->Cancel();
}

absl::Status Computation::Receive(uint64_t bytes) { return memory_.ReserveUpload(bytes); }

absl::Status Computation::ReceiveMesh(MeshUpload upload) {
  return WithoutExceptions([&]() -> absl::Status {
    mesh_bytes_ = upload.size();
    upload_ms_ = upload.milliseconds().value_or(0);
    mesh_ = std::move(upload).Release();
    if (!spec_.mesh_digest) return absl::OkStatus();
    if (mesh_.empty()) {
      std::optional<absl::Cord> kept = environment_.meshes.Find(*spec_.mesh_digest);
      if (!kept) return UnknownMesh();
      mesh_ = *std::move(kept);
      mesh_comes_again_ = true;
      mesh_bytes_ = mesh_.size();
      const uint64_t limit = environment_.limits.max_mesh_bytes;
      if (mesh_bytes_ > limit) return LimitExceeded("mesh_bytes", mesh_bytes_, limit);
      if (absl::Status status = memory_.ReserveUpload(mesh_bytes_); !status.ok()) return status;
      if (spec_.mesh_bytes == 0 || spec_.mesh_bytes == mesh_bytes_) return absl::OkStatus();
      return BadSpec(absl::StrCat("mesh_bytes ", spec_.mesh_bytes, " was declared, but the mesh has ", mesh_bytes_),
                     "mesh_bytes", absl::StrCat(spec_.mesh_bytes), absl::StrCat(mesh_bytes_));
    }
    const auto was_stored = environment_.meshes.PutIfItHas(*spec_.mesh_digest, mesh_, stop_.Signal());
    mesh_comes_again_ = was_stored.ok() && *was_stored;
    return was_stored.status();
  });
}

// It takes no longer than a copy, so it needs no process of its own.
absl::Status Computation::ReadRaw(const RawMeshLayout& layout) {
  return WithoutExceptions([&]() -> absl::Status {
    absl::Status status = memory_.ReserveDecode(mesh_bytes_, layout.triangles,
                                                layout.has_doubles ? AsFloats(layout.vertices) : layout.vertices);
    if (!status.ok()) return status;
    auto mesh = ReadRawMesh(std::exchange(mesh_, {}), layout, spec_.request.fields.OfMesh(), stop_.Signal());
    facts_.decode_ms = MillisecondsSince(decode_began_);
    return mesh.ok() ? ReceiveDecoded(DecodedMesh{*std::move(mesh)}) : mesh.status();
  });
}

bool Computation::IsTiny() const {
  return !large_ && !spec_.request.verify && facts_.estimated_ms < kTinyMilliseconds &&
         facts_.voxelize_ms < kMostTinyMilliseconds;
}

std::optional<absl::Status> Computation::DecodeAtOnce() {
  if (FindDecoded()) return ReserveForJob(kept_->mesh);
  if (!spec_.raw_mesh) return std::nullopt;
  decode_began_ = Clock::now();
  return ReadRaw(*spec_.raw_mesh);
}

MeshReading Computation::reading() const { return {spec_.request.fields.OfMesh(), spec_.raw_mesh}; }

void Computation::Decode(std::function<void(const absl::Status&)> decoded) {
  decode_began_ = Clock::now();
  const std::lock_guard lock(decoding_mu_);
  decoding_ = environment_.decoder.Start(
      {std::exchange(mesh_, {}), spec_.request.fields.OfMesh(), request_id_, environment_.client}, environment_.limits,
      [this](uint64_t triangles, uint64_t vertices) { return memory_.ReserveDecode(mesh_bytes_, triangles, vertices); },
      [this, decoded = std::move(decoded)](absl::StatusOr<DecodedMesh> mesh) {
        facts_.decode_ms = MillisecondsSince(decode_began_);
        decoded(ReceiveDecoded(std::move(mesh)));
      });
  if (stop_.Stopped()) decoding_->Cancel();
}

// A mesh over this caller's limits is decoded again, which refuses it.
bool Computation::FindDecoded() {
  if (!mesh_comes_again_) return false;
  kept_ = environment_.meshes.FindDecoded(*spec_.mesh_digest, reading());
  const Limits& limits = environment_.limits;
  if (kept_ &&
      (kept_->mesh.triangles.size() > limits.max_triangles || kept_->mesh.vertex_count() > limits.max_vertices)) {
    kept_.reset();
  }
  if (kept_) mesh_.Clear();
  return kept_ != nullptr;
}

void Computation::Free() {
  facts_.cpu_ms = 1e3 * (cpu_.Seconds() + (job_ ? job_->CpuSeconds() : 0));
  facts_.reserved_bytes = memory_.most_bytes();
  running_ = nullptr;
  job_.reset();
  voxels_ = {};
  mesh_.Clear();
  decoded_ = {};
  kept_.reset();
  memory_.Free();
}

absl::Status Computation::ReceiveDecoded(absl::StatusOr<DecodedMesh> mesh) {
  if (!mesh.ok()) return mesh.status();
  decoded_ = *std::move(mesh);
  return ReserveForJob(decoded_.mesh);
}

absl::Status Computation::ReserveForJob(const TriangleMesh& mesh) {
  if (absl::Status status = CheckCancelled(); !status.ok()) return status;
  const uint64_t triangles = mesh.triangles.size();
  const uint64_t vertices = mesh.vertices.size() + AsFloats(mesh.double_vertices.size());
  facts_.estimated_ms = EstimateMilliseconds(spec_.request, triangles, 0);
  large_ = facts_.estimated_ms > kLongMilliseconds;
  return memory_.ReserveMesh(triangles, vertices);
}

// Finds the mesh's extent. Lets the store keep a mesh that has come again; most meshes come once.
void Computation::ShareIfItComesAgain() {
  decoded_.extent = ExtentOf(decoded_.mesh, stop_.Signal());
  if (!mesh_comes_again_ || stop_.Stopped()) return;
  kept_ = environment_.meshes.KeepDecoded(*spec_.mesh_digest, reading(), std::move(decoded_));
}

JobEstimate Computation::EstimateJob(const TriangleMesh& mesh, double voxels) const {
  const MeshExtent& extent = mesh_of_job().extent;
  const double walks = MostWalks(mesh, spec_.request, stop_.Signal());
  return {voxels,
          EstimateLineCrossings(mesh, *grid_, spec_.request, stop_.Signal()),
          source_.bounds,
          grid_->lattice.voxel_size(),
          walks,
          MostWallTiles(mesh, extent, *grid_, spec_.request, walks, stop_.Signal()),
          MostWalkPoints(extent, *grid_, spec_.request)};
}

// Verification counts without tiles, and takes some twenty times as long as the scan.
bool Computation::VerifiesLong() const {
  constexpr double kTimes = 20;
  return spec_.request.verify &&
         EstimateMilliseconds(spec_.request, facts_.triangles, kTimes * visits_) > kLongMilliseconds;
}

absl::Status Computation::CheckVisits(absl::string_view what, double visits) const {
  const uint64_t limit = environment_.limits.max_visited_points;
  if (!(visits <= static_cast<double>(limit))) {                          // also not a number
    const auto estimate = static_cast<uint64_t>(std::min(1e19, visits));  // 1e19 for no number
    return MakeError(absl::StatusCode::kResourceExhausted,
                     absl::StrCat(what, " ", estimate, " exceeds ", limit, "; ask for larger voxels or for a part"),
                     {"LIMIT_EXCEEDED", "visited_points", absl::StrCat(estimate), absl::StrCat(limit)});
  }
  return absl::OkStatus();
}

absl::Status Computation::Measure() {
  return WithoutExceptions([&]() -> absl::Status {
    if (absl::Status status = CheckCancelled(); !status.ok()) return status;
    const Stopwatch stopwatch(facts_.voxelize_ms);
    const CpuMeter::Scope scope(cpu_);
    if (!kept_) ShareIfItComesAgain();
    const DecodedMesh& decoded = mesh_of_job();
    facts_.triangles = decoded.mesh.triangles.size();
    source_ = {decoded.extent.bounds, decoded.quantization_bits};
    if (absl::Status status = CheckCancelled(); !status.ok()) return status;
    absl::StatusOr<Grid> grid =
        ResolveGrid(spec_.grid.lattice, spec_.grid.sampling, spec_.grid.origin, source_.bounds, spec_.placement);
    if (!grid.ok()) return WithCauseOfCore(grid.status(), spec_.fields);
    grid_ = *std::move(grid);
    const VoxelRequest& request = spec_.request;
    estimate_ =
        EstimateJob(decoded.mesh, EstimateVoxels(decoded.mesh, decoded.extent, *grid_, request, stop_.Signal()));
    visits_ = WithPreparation(EstimateVisits(decoded.mesh, decoded.extent, *grid_, request, stop_.Signal()), request,
                              estimate_.line_crossings, estimate_.wall_tiles);
    facts_.estimated_ms = EstimateMilliseconds(request, facts_.triangles, visits_);
    large_ = facts_.estimated_ms > kLongMilliseconds;
    return CheckCancelled();
  });
}

absl::Status Computation::CreateJob() {
  const Stopwatch stopwatch(facts_.voxelize_ms);
  VoxelRequest request = spec_.request;
  if (spec_.request.verify) request.part.resume_after.reset();  // verify the whole result
  {
    const CpuMeter::Scope scope(cpu_);
    const std::shared_ptr<const DecodedMesh> kept = std::move(kept_);
    auto job = kept ? VoxelizeJob::CreateFromValid({kept, &kept->mesh}, *grid_, request, stop_.Signal())
                    : VoxelizeJob::CreateFromValid(std::move(decoded_.mesh), *grid_, request, stop_.Signal());
    if (!job.ok()) return WithCauseOfCore(job.status(), spec_.fields);
    job_ = *std::move(job);
  }
  running_ = job_.get();
  if (absl::Status status = CheckCancelled(); !status.ok()) return status;  // see Cancel
  if (absl::Status status = CheckVisits("visited_points (estimated)", visits_); !status.ok()) return status;
  if (absl::Status status = memory_.ReserveJob(estimate_); !status.ok()) return status;
  if (spec_.request.part.resume_after && !job_->facts().HasTile(*spec_.request.part.resume_after)) {
    return BadResumePoint(*spec_.request.part.resume_after);
  }
  if (absl::Status status = job_->Prepare(); !status.ok()) return WithCauseOfCore(status);
  return CheckCancelled();
}

absl::Status Computation::Oversee() {
  VoxelizeJob* const job = running_;
  const double seconds = cpu_.Seconds() + (job == nullptr ? 0 : job->CpuSeconds());
  const double limit = absl::ToDoubleSeconds(environment_.limits.max_job_time);
  if (seconds > limit) {
    const std::string value = absl::StrFormat("%.1f", seconds), most = absl::StrCat(limit);
    return MakeError(absl::StatusCode::kResourceExhausted,
                     absl::StrCat("job_seconds ", value, " of CPU time exceed ", most),
                     {"LIMIT_EXCEEDED", "job_seconds", value, most});
  }
  constexpr Clock::rep kLong = Clock::duration(std::chrono::milliseconds(static_cast<int>(kLongMilliseconds))).count();
  const Clock::rep since = small_since_;
  if (job != nullptr && since != 0 && Clock::now().time_since_epoch().count() - since > kLong) job->Interrupt();
  return absl::OkStatus();
}

absl::Status Computation::Start(const Deliver& deliver) {
  return WithoutExceptions([&]() -> absl::Status {
    if (absl::Status status = CheckCancelled(); !status.ok()) return status;
    if (absl::Status status = CreateJob(); !status.ok()) return status;
    v1::VoxelizeResponse response;
    *response.mutable_accepted() =
        AcceptedToProto(request_id_, spec_.request, *grid_, spec_.placement, job_->facts(), source_);
    deliver(std::move(response));
    last_delivery_ = paused_at_ = Clock::now();
    return absl::OkStatus();
  });
}

absl::StatusOr<bool> Computation::Advance(const Deliver& deliver, const std::function<bool()>& make_way) {
  return WithoutExceptions([&]() -> absl::StatusOr<bool> {
    facts_.stream_ms += MillisecondsSince(paused_at_);
    absl::StatusOr<bool> done = false;
    {
      const Stopwatch stopwatch(facts_.voxelize_ms);
      const Clock::time_point now = Clock::now(), slice_end = now + kSlice;
      small_since_ = large_ ? 0 : now.time_since_epoch().count();
      done = job_->Advance([&](TileBricks&& tile) {
        const bool more = HandleTile(std::move(tile), deliver);
        return more && (Clock::now() < slice_end || !make_way());
      });
      small_since_ = 0;
    }
    if (!done.ok()) return done;
    if (!failure_.ok()) return failure_;
    facts_.voxels = totals().voxels;
    facts_.bricks = totals().bricks;
    large_ |= facts_.voxelize_ms > kLongMilliseconds;  // whatever the estimate was
    if (absl::Status status = CheckVisits("voxels", static_cast<double>(facts_.voxels)); !status.ok()) return status;
    paused_at_ = Clock::now();
    if (!*done) return false;
    if (!large_ && VerifiesLong()) {
      large_ = true;
      return false;
    }
    if (absl::Status status = DeliverSummary(deliver); !status.ok()) return status;
    return true;
  });
}

// Totals of the delivered part.
const JobTotals& Computation::totals() const { return DeliversTheEndOnly() ? delivered_ : job_->totals(); }

bool Computation::DeliversTheEndOnly() const { return spec_.request.verify && spec_.request.part.resume_after; }

bool Computation::HandleTile(TileBricks tile, const Deliver& deliver) {
  if (!failure_.ok()) return false;
  if (spec_.request.verify) {
    failure_ = KeepForVerification(tile);
    if (!failure_.ok()) return false;
  }
  if (DeliversTheEndOnly()) {
    const Vec3i& first = job_->facts().first_tile_ijk;
    if (TileNumber(tile.tile_ijk - first) <= TileNumber(*spec_.request.part.resume_after - first)) return true;
    delivered_.Add(tile);
  }
  return AddToBatch(std::move(tile), deliver);
}

// A tile with large fields leaves in several batches.
bool Computation::AddToBatch(TileBricks tile, const Deliver& deliver) {
  std::vector<TileBricks> parts = BrickBatcher::PartsOf(std::move(tile));
  bool more = true;
  if (parts.size() > 1 && !batcher_.empty()) more = DeliverBatch(deliver);
  for (size_t n = 0; n + 1 < parts.size(); ++n) {
    batcher_.Add(parts[n]);
    more &= DeliverBatch(deliver, /*tile_continues=*/true);
  }
  batcher_.Add(parts.back());
  if (!batcher_.full() && Clock::now() - last_delivery_ <= kMaxBatchAge) return more;
  return DeliverBatch(deliver) && more;
}

absl::Status Computation::KeepForVerification(const TileBricks& tile) {
  if (absl::Status status = memory_.ReserveKept(tile.bricks.size()); !status.ok()) return status;
  for (const Brick& brick : tile.bricks) voxels_.Add(brick);
  return absl::OkStatus();
}

bool Computation::DeliverBatch(const Deliver& deliver, bool tile_continues) {
  last_delivery_ = Clock::now();
  v1::VoxelizeResponse response;
  *response.mutable_bricks() = batcher_.Release(tile_continues);
  return deliver(std::move(response));
}

absl::Status Computation::DeliverSummary(const Deliver& deliver) {
  if (!batcher_.empty()) DeliverBatch(deliver);
  std::optional<Verdict> verdict;
  if (spec_.request.verify) {
    const Stopwatch stopwatch(facts_.voxelize_ms);
    const absl::StatusOr<Verdict> verified = job_->Verify(voxels_);
    if (!verified.ok()) return verified.status();
    verdict = *verified;
  }
  v1::VoxelizeResponse response;
  v1::Summary& summary = *response.mutable_summary();
  summary.set_voxels(totals().voxels);
  summary.set_bricks(totals().bricks);
  summary.set_tiles(totals().tiles);
  *summary.mutable_certificate() = CertificateToProto(spec_, job_->facts(), source_, totals(), verdict);
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
