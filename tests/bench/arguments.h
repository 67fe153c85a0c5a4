// The command line of latvox_bench: what to measure.
#ifndef LATVOX_TESTS_BENCH_ARGUMENTS_H_
#define LATVOX_TESTS_BENCH_ARGUMENTS_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/simd.h"
#include "core/lattice/lattice.h"
#include "core/voxelizer/voxelizer.h"

namespace latvox {

inline constexpr int kMaxThreads = 1024;

struct Arguments {
  std::string mesh;     // see MeshNamed
  int subdivide = 0;    // how often each triangle is divided into four
  uint32_t copies = 1;  // of the mesh, each with a part number of its own; see Copied
  uint32_t resolution = 0;
  std::string lattice = "cartesian";
  std::vector<double> basis;  // empty or nine numbers, instead of `lattice`
  VoxelRequest request;
  Simd simd = Simd::kBest;
  int threads = 1, warmups = 0, reps = 7;
  std::string peer;      // measure this program instead of ours: "openvdb" or "recast"; see Peer
  bool discard = false;  // drop bricks as they arrive, for results larger than memory
  bool cancel = false;   // also measure cancellation
  bool json = false, help = false;
};

// Errors: INVALID_ARGUMENT.
absl::StatusOr<Arguments> ParseArguments(std::vector<std::string> words);

std::string Help();

// Errors: as Lattice::FromBasis.
absl::StatusOr<Lattice> LatticeOf(const Arguments& arguments);

}  // namespace latvox

#endif  // LATVOX_TESTS_BENCH_ARGUMENTS_H_
