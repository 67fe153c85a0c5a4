// Benchmarks of the stages of the core one by one, for each kind of kernel, and of the codec of bricks, on one thread.
//   latvox_bench_kernels --benchmark_filter=Tile
#include <benchmark/benchmark.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "core/base/simd.h"
#include "core/base/stop_signal.h"
#include "core/snap/mesh_range.h"
#include "core/snap/snap.h"
#include "core/tree/tile_tree.h"
#include "core/triangles/surface_facts.h"
#include "core/voxelizer/voxelizer.h"
#include "tests/bench/codec_kernels.h"
#include "tests/bench/meshes.h"

namespace latvox {
namespace {

constexpr Vec3i kReach{1, 1, 1};

// A mesh and its resolution. One tile is 64 voxels a side.
struct Scene {
  const char* name;
  const char* mesh;
  uint32_t resolution;
};
constexpr Scene kTinyTriangles{"tiny", "sphere:200000", 60};     // triangles of a third of a voxel
constexpr Scene kVoxelSized{"voxel_sized", "sphere:10000", 60};  // triangles of a voxel and a half
constexpr Scene kLargeTriangles{"large", "box", 60};

template <class T>
T OrDie(absl::StatusOr<T> value, const char* what) {
  if (value.ok()) return *std::move(value);
  absl::FPrintF(stderr, "latvox_bench_kernels: %s: %s\n", what, value.status().message());
  std::exit(3);
}

TriangleMesh MeshOf(const Scene& scene) { return OrDie(MeshNamed(scene.mesh), scene.mesh); }

Grid GridOf(const Scene& scene, const TriangleMesh& mesh) {
  const Lattice lattice = Lattice::Named(NamedLattice::kCartesian);
  return OrDie(ResolveGrid(lattice, {.resolution = scene.resolution}, std::nullopt, BoundsOf(mesh)), scene.name);
}

SnappedMesh SnappedOf(const Scene& scene) {
  TriangleMesh mesh = MeshOf(scene);
  const Grid grid = GridOf(scene, mesh);
  return OrDie(Snap(std::move(mesh), grid.lattice, grid.origin, kReach), scene.name);
}

void CountTriangles(benchmark::State& state, size_t triangles) {
  state.SetItemsProcessed(static_cast<int64_t>(state.iterations() * triangles));
}

void SnapMesh(benchmark::State& state, const Scene& scene) {
  const TriangleMesh mesh = MeshOf(scene);
  const Grid grid = GridOf(scene, mesh);
  for (auto _ : state) {
    state.PauseTiming();
    TriangleMesh copy = mesh;
    state.ResumeTiming();
    benchmark::DoNotOptimize(Snap(std::move(copy), grid.lattice, grid.origin, kReach));
  }
  CountTriangles(state, mesh.triangles.size());
}

void Facts(benchmark::State& state, const Scene& scene) {
  const SnappedMesh mesh = SnappedOf(scene);
  for (auto _ : state) benchmark::DoNotOptimize(FactsOf(mesh));
  CountTriangles(state, mesh.triangles.size());
}

size_t CountTiles(const TileTree& tree, const std::vector<TileNode>& nodes) {
  size_t tiles = 0;
  for (const TileNode& node : nodes) tiles += node.level == 0 ? 1 : CountTiles(tree, tree.Children(node));
  return tiles;
}

void Tree(benchmark::State& state, const Scene& scene) {
  const SnappedMesh mesh = SnappedOf(scene);
  const TileTree tree(mesh, 0, kReach, kReach, mesh.box, StopSignal());
  size_t tiles = 0;
  for (auto _ : state) tiles = CountTiles(tree, tree.Top());
  state.counters["tiles"] = static_cast<double>(tiles);
  CountTriangles(state, mesh.triangles.size());
}

// A whole job, from the valid mesh in memory. It counts voxels as items if triangles are larger than voxels.
void Job(benchmark::State& state, const Scene& scene, const VoxelizeOptions& options) {
  const TriangleMesh mesh = MeshOf(scene);
  const Grid grid = GridOf(scene, mesh);
  const VoxelRequest request = OrDie(MakeRequest(options), scene.name);
  uint64_t voxels = 0;
  for (auto _ : state) {
    state.PauseTiming();
    TriangleMesh copy = mesh;
    state.ResumeTiming();
    const auto job = OrDie(VoxelizeJob::CreateFromValid(std::move(copy), grid, request), scene.name);
    job->Advance([](TileBricks&&) { return true; }).IgnoreError();
    voxels = job->totals().voxels;
  }
  state.counters["voxels"] = static_cast<double>(voxels);
  CountTriangles(state, std::max<uint64_t>(mesh.triangles.size(), voxels));
}

// Registers `run` for each kind of kernel that this processor has.
void Register(const std::string& name, const std::function<void(benchmark::State&)>& run) {
  for (const auto& [simd, simd_name] : kSimdNames) {
    if (simd == Simd::kBest || !ForceSimd(simd).ok()) continue;
    benchmark::RegisterBenchmark((name + '/' + std::string(simd_name)).c_str(), [run, simd = simd](auto& state) {
      ForceSimd(simd).IgnoreError();
      run(state);
    });
  }
}

void RegisterAll() {
  constexpr Scene kManyTiles{"many_tiles", "sphere:200000", 1024};
  Register("Snap", [=](auto& state) { SnapMesh(state, kManyTiles); });
  Register("Facts", [=](auto& state) { Facts(state, kManyTiles); });
  Register("Tree", [=](auto& state) { Tree(state, kManyTiles); });
  for (const Scene& scene : {kTinyTriangles, kVoxelSized, kLargeTriangles}) {
    Register(std::string("Job/") + scene.name + "/supercover",
             [=](auto& state) { Job(state, scene, {.set = SupercoverSurface{}}); });
    for (const int k : {0, 2}) {
      for (const bool minimal : {true, false}) {
        const std::string name =
            std::string("Job/") + scene.name + "/k" + std::to_string(k) + (minimal ? "/thinned" : "/unthinned");
        Register(name, [=](auto& state) { Job(state, scene, {.separability = k, .minimal = minimal}); });
      }
    }
  }
}

}  // namespace
}  // namespace latvox

int main(int argc, char** argv) {
  const oneapi::tbb::global_control one_thread(oneapi::tbb::global_control::max_allowed_parallelism, 1);
  latvox::RegisterAll();
  latvox::RegisterCodec();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
