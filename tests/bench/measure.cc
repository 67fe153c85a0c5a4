#include "tests/bench/measure.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>
#include <memory>
#include <thread>
#include <utility>

#include "core/snap/mesh_range.h"
#include "tests/bench/peak_memory.h"
#include "tests/bench/peer.h"

namespace latvox {
namespace {

using Clock = std::chrono::steady_clock;

double Milliseconds(Clock::duration duration) { return std::chrono::duration<double, std::milli>(duration).count(); }

// The time of all threads, in user and system mode.
double ProcessorMilliseconds() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

// A job, and the memory that must be freed after the clock stops.
struct Run {
  TriangleMesh mesh;
  std::unique_ptr<VoxelizeJob> job = nullptr;
  std::vector<TileBricks> tiles = {};
  absl::Status status = absl::OkStatus();
  Clock::time_point start{}, first_tile{}, end{};
};

// All of the timed work. tests/bench/instructions counts the instructions of this function.
extern "C" [[gnu::noinline]] void latvox_bench_job(const Arguments& arguments, const Grid& grid, Run& run) {
  run.start = Clock::now();
  auto job = VoxelizeJob::CreateFromValid(std::move(run.mesh), grid, arguments.request);
  run.status = job.status();
  if (!job.ok()) return;
  run.job = *std::move(job);
  const auto sink = [&](TileBricks&& tile) {
    if (run.first_tile == Clock::time_point{}) run.first_tile = Clock::now();
    if (!arguments.discard) run.tiles.push_back(std::move(tile));
    return true;
  };
  run.status = run.job->Advance(sink).status();
  run.end = Clock::now();
}

// Returns the longest time from a cancel to the end of Create or Advance, which return once every thread has stopped.
// It cancels at five points of the work, which takes `whole` in all.
absl::StatusOr<double> MostToCancel(const Arguments& arguments, const TriangleMesh& mesh, const Grid& grid,
                                    Clock::duration whole) {
  double most = 0;
  for (const int percent : {5, 25, 50, 75, 95}) {
    TriangleMesh copy = mesh;
    StopSource cancel;
    std::atomic<VoxelizeJob*> running = nullptr;
    Clock::time_point cancelled;
    std::thread canceller([&] {
      std::this_thread::sleep_for(whole * percent / 100);
      cancelled = Clock::now();
      cancel.Stop();
      if (VoxelizeJob* const job = running) job->Cancel();
    });
    auto job = VoxelizeJob::CreateFromValid(std::move(copy), grid, arguments.request, cancel.Signal());
    if (job.ok()) {
      running = job->get();
      if (cancel.Stopped()) (*job)->Cancel();
      (*job)->Advance([](TileBricks&&) { return true; }).IgnoreError();
    }
    const auto end = Clock::now();
    canceller.join();
    if (!job.ok() && !absl::IsCancelled(job.status())) return job.status();
    most = std::max(most, Milliseconds(end - cancelled));  // negative: too late
  }
  return most;
}

TriangleMesh CopyOrTake(TriangleMesh& mesh, bool take) {
  if (take) return std::move(mesh);
  return mesh;
}

absl::StatusOr<Measurement> MeasureOurs(const Arguments& arguments, const Grid& grid, TriangleMesh& mesh,
                                        bool last_use) {
  Measurement out;
  out.simd = SimdInUse();
  std::optional<PeakMemory> memory;
  Clock::duration whole{};
  const int runs = arguments.warmups + arguments.reps;
  for (int n = 0; n < runs; ++n) {
    Run run{CopyOrTake(mesh, last_use && !arguments.cancel && n + 1 == runs)};
    if (!memory) memory.emplace();
    const double processor = ProcessorMilliseconds();
    latvox_bench_job(arguments, grid, run);
    const double processor_end = ProcessorMilliseconds();
    if (!run.status.ok()) return run.status;
    const JobTotals& totals = run.job->totals();
    if (!out.digest.empty() && out.digest != totals.digest.ToHex()) {
      return absl::InternalError("repetitions differ in their digests");
    }
    out.voxels = totals.voxels;
    out.digest = totals.digest.ToHex();
    whole = run.end - run.start;
    if (n < arguments.warmups) continue;
    out.milliseconds.push_back(Milliseconds(run.end - run.start));
    out.processor_milliseconds.push_back(processor_end - processor);
    if (run.first_tile == Clock::time_point{}) continue;
    const double first = Milliseconds(run.first_tile - run.start);
    out.first_brick_milliseconds = std::min(first, out.first_brick_milliseconds.value_or(first));
  }
  out.peak_rss_bytes = memory->Bytes();
  out.job_peak_bytes = memory->BytesBeyondStart();
  if (arguments.cancel) {
    const auto most = MostToCancel(arguments, mesh, grid, whole);
    if (!most.ok()) return most.status();
    out.cancel_milliseconds = *most;
  }
  return out;
}

absl::StatusOr<std::unique_ptr<Peer>> PeerOf(const Arguments& arguments, const Grid& grid, const TriangleMesh& mesh) {
  const double voxel_size = grid.lattice.voxel_size();
  if (arguments.peer == "recast") return RecastPeer(mesh, BoundsOf(mesh), voxel_size);
  const Band* const band = arguments.request.band();
  return OpenVdbPeer(mesh, BoundsOf(mesh), voxel_size, band != nullptr ? static_cast<float>(band->width) : 0.5F);
}

absl::StatusOr<Measurement> MeasurePeer(const Arguments& arguments, const Grid& grid, const TriangleMesh& mesh) {
  const auto peer = PeerOf(arguments, grid, mesh);
  if (!peer.ok()) return peer.status();
  Measurement out;
  out.simd = arguments.peer;
  const PeakMemory memory;
  for (int n = 0; n < arguments.warmups + arguments.reps; ++n) {
    const double processor = ProcessorMilliseconds();
    const auto start = Clock::now();
    if (auto status = (*peer)->Run(); !status.ok()) return status;
    const auto end = Clock::now();
    const double processor_end = ProcessorMilliseconds();
    if (n >= arguments.warmups) {
      out.milliseconds.push_back(Milliseconds(end - start));
      out.processor_milliseconds.push_back(processor_end - processor);
    }
    out.voxels = (*peer)->Finish();
  }
  out.peak_rss_bytes = memory.Bytes();
  out.job_peak_bytes = memory.BytesBeyondStart();
  return out;
}

void StartThreads(int threads) {
  oneapi::tbb::parallel_for(0, threads * 4, [](int) { std::this_thread::sleep_for(std::chrono::milliseconds(1)); });
}

}  // namespace

absl::StatusOr<Measurement> Measure(const Arguments& arguments, TriangleMesh& mesh, bool last_use) {
  if (auto status = ForceSimd(arguments.simd); !status.ok()) return status;
  const auto lattice = LatticeOf(arguments);
  if (!lattice.ok()) return lattice.status();
  const auto grid = ResolveGrid(*lattice, {.resolution = arguments.resolution}, std::nullopt, BoundsOf(mesh));
  if (!grid.ok()) return grid.status();

  const uint64_t triangles = mesh.triangles.size();
  const uint32_t numbers = arguments.request.fields.OfMesh().size();
  mesh.attributes.clear();
  for (size_t n = 0; n < mesh.vertex_count() * numbers; ++n) {
    const size_t per_part = arguments.copies > 1 ? mesh.vertex_count() * numbers / arguments.copies : 4096;
    mesh.attributes.push_back(static_cast<uint32_t>(n / per_part));
  }
  oneapi::tbb::task_arena arena(arguments.threads);
  auto measured = arena.execute([&]() -> absl::StatusOr<Measurement> {
    StartThreads(arguments.threads);
    if (!arguments.peer.empty()) return MeasurePeer(arguments, *grid, mesh);
    return MeasureOurs(arguments, *grid, mesh, last_use);
  });
  if (!measured.ok()) return measured.status();
  measured->triangles = triangles;
  std::sort(measured->milliseconds.begin(), measured->milliseconds.end());
  std::sort(measured->processor_milliseconds.begin(), measured->processor_milliseconds.end());
  return measured;
}

}  // namespace latvox
