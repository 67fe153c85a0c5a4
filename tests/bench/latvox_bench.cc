// The core alone, memory to memory: from a mesh in memory to all bricks in memory.
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "absl/strings/str_format.h"
#include "client/mesh/mesh_file.h"
#include "core/voxelizer/voxelizer.h"
#include "server/draco_decoder.h"
#include "tests/bench/peer_openvdb.h"

namespace latvox {
namespace {

struct Arguments {
  std::string mesh, lattice = "cartesian", algorithm = "exact", simd = "best", peer;
  std::vector<double> basis;
  uint32_t resolution = 0;
  int separability = 0, threads = 1, reps = 7;
  bool minimal = true, json = false;
};

struct Measurement {
  uint64_t voxels = 0;
  std::string digest;
  std::vector<double> milliseconds;
};

absl::StatusOr<TriangleMesh> ReadMesh(const std::string& path) {
  if (client::IsDracoFile(path)) {
    const auto bytes = client::ReadBytes(path);
    if (!bytes.ok()) return bytes.status();
    auto decoded = DracoDecoder().Decode(*bytes, Limits());
    if (!decoded.ok()) return decoded.status();
    return std::move(decoded->mesh);
  }
  auto mesh = client::ReadMeshFile(path);
  if (!mesh.ok()) return mesh.status();
  return TriangleMesh{std::move(mesh->positions), std::move(mesh->triangles)};
}

absl::StatusOr<Lattice> LatticeOf(const Arguments& arguments) {
  if (arguments.basis.size() == 9) {
    const auto& b = arguments.basis;
    return Lattice::FromBasis({{{b[0], b[1], b[2]}, {b[3], b[4], b[5]}, {b[6], b[7], b[8]}}});
  }
  static const std::map<std::string, NamedLattice> names{{"cartesian", NamedLattice::kCartesian},
                                                         {"bcc", NamedLattice::kBcc},
                                                         {"fcc", NamedLattice::kFcc},
                                                         {"hexagonal", NamedLattice::kHexagonal}};
  return Lattice::Named(names.at(arguments.lattice));
}

double Milliseconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

absl::StatusOr<Measurement> MeasureOurs(const Arguments& arguments, const TriangleMesh& mesh, const Grid& grid) {
  Measurement out;
  const VoxelizeOptions options{.separability = arguments.separability, .minimal = arguments.minimal};
  for (int rep = 0; rep < arguments.reps; ++rep) {
    TriangleMesh copy = mesh;  // the job takes its mesh over
    std::vector<TileBricks> tiles;
    absl::Status status;
    std::unique_ptr<VoxelizeJob> kept;  // freed after the clock
    out.milliseconds.push_back(Milliseconds([&] {
      auto job = VoxelizeJob::Create(std::move(copy), grid, options);
      if (!job.ok()) {
        status = job.status();
        return;
      }
      kept = *std::move(job);
      status = kept->Advance([&](TileBricks&& tile) {
                     tiles.push_back(std::move(tile));
                     return true;
                   })
                   .status();
    }));
    if (!status.ok()) return status;
    out.voxels = kept->totals().voxels;
    out.digest = kept->totals().digest.ToHex();
  }
  return out;
}

Measurement MeasureOpenVdb(const Arguments& arguments, const TriangleMesh& mesh, const Grid& grid) {
  Measurement out;
  const OpenVdbPeer peer(mesh, BoundsOf(mesh), grid.lattice.voxel_size());
  for (int rep = 0; rep < arguments.reps; ++rep) {
    out.milliseconds.push_back(Milliseconds([&] { out.voxels = peer.Run(); }));
  }
  return out;
}

uint64_t PeakRssBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

void Print(const Arguments& arguments, const TriangleMesh& mesh, Measurement measurement) {
  auto& ms = measurement.milliseconds;
  std::sort(ms.begin(), ms.end());
  const double least = ms.front(), median = ms[ms.size() / 2];
  const double ns_per_triangle = least * 1e6 / static_cast<double>(mesh.triangles.size());
  const double mvoxels_per_s = static_cast<double>(measurement.voxels) / least / 1e3;
  const std::string simd = arguments.peer.empty() ? "scalar" : "openvdb";
  if (arguments.json) {
    nlohmann::ordered_json out{{"voxels", measurement.voxels},
                               {"ms_min", least},
                               {"ms_median", median},
                               {"ns_per_triangle", ns_per_triangle},
                               {"mvoxels_per_s", mvoxels_per_s},
                               {"peak_rss_bytes", PeakRssBytes()},
                               {"threads", arguments.threads},
                               {"simd", simd},
                               {"digest", measurement.digest}};
    std::puts(out.dump().c_str());
    return;
  }
  absl::PrintF("%d voxels  %.2f ms min  %.2f ms median  %.1f ns/triangle  %.1f Mvoxels/s  %.0f MB peak  %s\n",
               measurement.voxels, least, median, ns_per_triangle, mvoxels_per_s,
               static_cast<double>(PeakRssBytes()) / 1e6, simd);
}

int Fail(const absl::Status& status) {
  std::fprintf(stderr, "latvox_bench: %s\n", std::string(status.message()).c_str());
  return 3;
}

int Run(const Arguments& arguments) {
  const auto mesh = ReadMesh(arguments.mesh);
  if (!mesh.ok()) return Fail(mesh.status());
  const auto lattice = LatticeOf(arguments);
  if (!lattice.ok()) return Fail(lattice.status());
  const auto grid = ResolveGrid(*lattice, {.resolution = arguments.resolution}, std::nullopt, BoundsOf(*mesh));
  if (!grid.ok()) return Fail(grid.status());

  const auto threads = static_cast<size_t>(arguments.threads);
  const oneapi::tbb::global_control control(oneapi::tbb::global_control::max_allowed_parallelism, threads);
  oneapi::tbb::task_arena arena(arguments.threads);
  return arena.execute([&] {
    // Starts the threads before the clock.
    oneapi::tbb::parallel_for(0, arguments.threads * 4,
                              [](int) { std::this_thread::sleep_for(std::chrono::milliseconds(1)); });
    if (arguments.peer == "openvdb") {
      Print(arguments, *mesh, MeasureOpenVdb(arguments, *mesh, *grid));
      return 0;
    }
    auto ours = MeasureOurs(arguments, *mesh, *grid);
    if (!ours.ok()) return Fail(ours.status());
    Print(arguments, *mesh, *std::move(ours));
    return 0;
  });
}

}  // namespace
}  // namespace latvox

int main(int argc, char** argv) {
  latvox::Arguments arguments;
  CLI::App app("Times the voxelizer, memory to memory.");
  app.add_option("MESH", arguments.mesh, ".drc .obj .ply .stl .glb .gltf")->required();
  app.add_option("RESOLUTION", arguments.resolution, "voxels along the longest side")
      ->required()
      ->check(CLI::Range(2, 65536));
  app.add_option("--lattice", arguments.lattice)->check(CLI::IsMember({"cartesian", "bcc", "fcc", "hexagonal"}));
  app.add_option("--basis", arguments.basis, "three basis vectors")->delimiter(',')->expected(9);
  app.add_option("--separability", arguments.separability)->check(CLI::Range(0, 2));
  app.add_flag("--minimal,!--no-minimal", arguments.minimal);
  app.add_option("--algorithm", arguments.algorithm)->check(CLI::IsMember({"exact"}));
  app.add_option("--threads", arguments.threads)->check(CLI::Range(1, 1024));
  app.add_option("--reps", arguments.reps)->check(CLI::Range(1, 1000));
  app.add_option("--simd", arguments.simd, "kernel")->check(CLI::IsMember({"scalar", "best"}));
  app.add_option("--peer", arguments.peer, "times another program instead")->check(CLI::IsMember({"openvdb"}));
  app.add_flag("--json", arguments.json);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  return latvox::Run(arguments);
}
