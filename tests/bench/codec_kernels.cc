#include "tests/bench/codec_kernels.h"

#include <benchmark/benchmark.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/internal/brick_codec.h"
#include "core/snap/mesh_range.h"
#include "core/voxelizer/voxelizer.h"
#include "latvox/v1/voxelizer.pb.h"
#include "server/wire/brick_batch.h"
#include "tests/bench/meshes.h"

namespace latvox {
namespace {

constexpr size_t kRawBrickBytes = 76;

// Returns all tiles of the bunny at 1024.
struct Bunny {
  std::vector<TileBricks> tiles;
  JobTotals totals;
};

Bunny MakeBunny(NamedLattice lattice, int separability) {
  constexpr char kMesh[] = "/usr/share/glmark2/models/bunny.obj";
  absl::StatusOr<TriangleMesh> mesh = MeshNamed(kMesh);
  if (mesh.ok()) {
    const auto grid = ResolveGrid(Lattice::Named(lattice), {.resolution = 1024}, std::nullopt, BoundsOf(*mesh));
    if (auto job = VoxelizeJob::Create(*std::move(mesh), *grid, {.separability = separability}); job.ok()) {
      Bunny bunny;
      const auto done =
          (*job)->Advance([&](TileBricks&& tile) { return bunny.tiles.push_back(std::move(tile)), true; });
      bunny.totals = (*job)->totals();
      if (done.ok() && *done) return bunny;
    }
  }
  absl::FPrintF(stderr, "latvox_bench_kernels: %s cannot be voxelized\n", kMesh);
  std::exit(3);
}

std::vector<v1::BrickBatch> Encode(const Bunny& bunny, BrickEncoding encoding) {
  std::vector<v1::BrickBatch> batches;
  BrickBatcher batcher(encoding);
  for (const TileBricks& tile : bunny.tiles) {
    batcher.Add(tile);
    if (batcher.full()) batches.push_back(batcher.Release());
  }
  if (!batcher.empty()) batches.push_back(batcher.Release());
  return batches;
}

// `bricks` and `packed` are kept, as in a client.
void Decode(const std::vector<v1::BrickBatch>& batches, std::vector<client::Brick>& bricks, std::string& packed) {
  for (const v1::BrickBatch& batch : batches) {
    const bool zstd = batch.packed_bytes() != 0;
    absl::Status status =
        zstd ? client::Decompress(batch.packed(), batch.packed_bytes(), client::kMaxPackedBytes, packed)
             : absl::OkStatus();
    if (status.ok()) status = client::UnpackBricks(zstd ? packed : batch.packed(), bricks);
    if (!status.ok()) std::abort();
    benchmark::DoNotOptimize(bricks.data());
  }
}

void Finish(const Bunny& bunny, const std::vector<v1::BrickBatch>& batches, benchmark::State& state) {
  size_t bytes = 0;
  for (const v1::BrickBatch& batch : batches) {
    v1::VoxelizeResponse message;
    *message.mutable_bricks() = batch;
    bytes += message.ByteSizeLong();
  }
  if (bytes != 0)
    state.counters["bits_per_voxel"] = 8.0 * static_cast<double>(bytes) / static_cast<double>(bunny.totals.voxels);
  state.SetBytesProcessed(static_cast<int64_t>(state.iterations() * bunny.totals.bricks * kRawBrickBytes));
}

void Copy(const Bunny& bunny, benchmark::State& state) {
  const std::vector<char> from(bunny.totals.bricks * kRawBrickBytes, 1);
  std::vector<char> to(from.size());
  for (auto _ : state) {
    std::memcpy(to.data(), from.data(), from.size());
    benchmark::ClobberMemory();
  }
  Finish(bunny, {}, state);
}

void Codec(const Bunny& bunny, BrickEncoding encoding, bool encode, bool decode, benchmark::State& state) {
  std::vector<v1::BrickBatch> batches = Encode(bunny, encoding);
  std::vector<client::Brick> bricks;
  std::string packed;
  for (auto _ : state) {
    if (encode) batches = Encode(bunny, encoding);
    if (decode) Decode(batches, bricks, packed);
  }
  Finish(bunny, batches, state);
}

}  // namespace

void RegisterCodec() {
  for (const auto& [name, lattice, separability] : {std::tuple{"cartesian_k0", NamedLattice::kCartesian, 0},
                                                    {"cartesian_k1", NamedLattice::kCartesian, 1},
                                                    {"cartesian_k2", NamedLattice::kCartesian, 2},
                                                    {"bcc", NamedLattice::kBcc, 0},
                                                    {"fcc_k2", NamedLattice::kFcc, 2}}) {
    // clang does not capture structured bindings.
    const auto add = [name = std::string(name), lattice = lattice, k = separability](const std::string& way, auto run) {
      const auto measure = [lattice, k, run](benchmark::State& state) {
        static std::map<std::pair<NamedLattice, int>, Bunny> bunnies;  // made on first use
        auto [at, made] = bunnies.try_emplace({lattice, k});
        if (made) at->second = MakeBunny(lattice, k);
        run(at->second, state);
      };
      benchmark::RegisterBenchmark(absl::StrCat("Codec/", name, "/", way).c_str(), measure);
    };
    add("memcpy", [](const Bunny& bunny, benchmark::State& state) { Copy(bunny, state); });
    for (const auto encoding : {BrickEncoding::kPacked, BrickEncoding::kPackedZstd}) {
      const std::string prefix = encoding == BrickEncoding::kPacked ? "" : "zstd_";
      for (const auto& [way, encode, decode] :
           {std::tuple{"pack", true, false}, {"unpack", false, true}, {"both", true, true}}) {
        add(prefix + way, [=, encode = encode, decode = decode](const Bunny& bunny, benchmark::State& state) {
          Codec(bunny, encoding, encode, decode, state);
        });
      }
    }
  }
}

}  // namespace latvox
