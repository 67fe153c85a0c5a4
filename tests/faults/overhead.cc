// Measures the overhead of the service: one job through a server and the same job within this process, in turns, so
// that other load hits both alike. Prints the medians as JSON. This process decodes the mesh each time. The server may
// keep the decoded mesh, as it does for every client.
#include <oneapi/tbb/info.h>
#include <oneapi/tbb/task_arena.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "client/mesh_files/input.h"
#include "core/snap/mesh_range.h"
#include "core/voxelizer/voxelizer.h"
#include "latvox/client.h"
#include "tests/bench/meshes.h"
#include "tests/faults/commands.h"

namespace latvox::faults {
namespace {

using Clock = std::chrono::steady_clock;

struct OverheadOptions {
  std::string server, mesh;
  uint32_t resolution = 512;
  int separability = 0;
  int rounds = 30;
};

double MillisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

struct Result {
  double ms = 0;
  std::string digest;
};

// Decodes and voxelizes to bricks in memory, as latvox_bench does.
absl::StatusOr<Result> InProcess(const OverheadOptions& options) {
  const Clock::time_point start = Clock::now();
  auto mesh = MeshNamed(options.mesh);
  if (!mesh.ok()) return mesh.status();
  const auto lattice = Lattice::FromBasis({{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
  if (!lattice.ok()) return lattice.status();
  const auto grid = ResolveGrid(*lattice, {.resolution = options.resolution}, std::nullopt, BoundsOf(*mesh));
  if (!grid.ok()) return grid.status();
  const auto job =
      VoxelizeJob::CreateFromValid(*std::move(mesh), *grid, VoxelRequest{.separability = options.separability});
  if (!job.ok()) return job.status();
  std::vector<TileBricks> tiles;
  const auto done = (*job)->Advance([&](TileBricks&& tile) { return tiles.push_back(std::move(tile)), true; });
  if (!done.ok()) return done.status();
  return Result{MillisecondsSince(start), (*job)->totals().digest.ToHex()};
}

absl::StatusOr<Result> ThroughServer(const OverheadOptions& options, const client::Client& client,
                                     const std::string& drc, client::ServerTimings& timings) {
  client::VoxelizeRequest request;
  request.resolution = options.resolution;
  request.separability = static_cast<uint32_t>(options.separability);
  std::vector<std::vector<client::Brick>> batches;
  const auto keep = [&](const client::BrickBatch& batch) {
    batches.emplace_back(batch.bricks.begin(), batch.bricks.end());
    return absl::OkStatus();
  };
  const Clock::time_point start = Clock::now();
  const auto summary = client.Voxelize(request, drc, {.on_bricks = keep});
  if (!summary.ok()) return summary.status();
  timings = summary->timings;
  return Result{MillisecondsSince(start), summary->certificate.digest};
}

absl::StatusOr<std::string> MeasureOverhead(const OverheadOptions& options) {
  const auto drc = client::ReadBytes(options.mesh);
  if (!drc.ok()) return drc.status();
  oneapi::tbb::task_arena arena(oneapi::tbb::info::default_concurrency());
  std::vector<double> service, kept, process, decode, voxelize, stream;
  for (int round = 0; round < options.rounds + 2; ++round) {
    // A new client sends the mesh. The second time, it knows that the server has it.
    const auto client = client::Client::Connect(options.server);
    if (!client.ok()) return client.status();
    client::ServerTimings timings, ignored;
    const auto theirs = ThroughServer(options, *client, *drc, timings);
    if (!theirs.ok()) return theirs.status();
    const auto again = ThroughServer(options, *client, *drc, ignored);
    if (!again.ok()) return again.status();
    const auto ours = arena.execute([&] { return InProcess(options); });
    if (!ours.ok()) return ours.status();
    if (ours->digest != theirs->digest) return absl::InternalError("the server's voxels are others");
    if (round < 2) continue;  // warm-up
    service.push_back(theirs->ms);
    kept.push_back(again->ms);
    process.push_back(ours->ms);
    decode.push_back(timings.decode_ms);
    voxelize.push_back(timings.voxelize_ms);
    stream.push_back(timings.stream_ms);
  }
  return nlohmann::json{{"service_ms", Median(service)},
                        {"service_with_kept_mesh_ms", Median(kept)},
                        {"process_ms", Median(process)},
                        {"service_min_ms", *std::min_element(service.begin(), service.end())},
                        {"process_min_ms", *std::min_element(process.begin(), process.end())},
                        {"server_decode_ms", Median(decode)},
                        {"server_voxelize_ms", Median(voxelize)},
                        {"server_stream_ms", Median(stream)}}
      .dump();
}

int RunOverhead(const OverheadOptions& options) {
  const auto json = MeasureOverhead(options);
  if (json.ok()) return std::puts(json->c_str()) < 0 ? 1 : 0;
  std::fprintf(stderr, "latvox_faults: %s\n", json.status().ToString().c_str());
  return 2;
}

}  // namespace

void AddOverhead(CLI::App& program, Command& run) {
  const auto options = std::make_shared<OverheadOptions>();
  CLI::App& command = *program.add_subcommand("overhead", "A job through the server and in one process, in turns");
  command.add_option("--server", options->server, "Address")->required();
  command.add_option("--mesh", options->mesh, "A .drc file")->required();
  command.add_option("--resolution", options->resolution);
  command.add_option("--separability", options->separability);
  command.add_option("--rounds", options->rounds);
  command.callback([options, &run] { run = [options] { return RunOverhead(*options); }; });
}

}  // namespace latvox::faults
