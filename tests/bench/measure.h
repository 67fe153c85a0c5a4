// Times one job, or another program, repeatedly.
#ifndef LATVOX_TESTS_BENCH_MEASURE_H_
#define LATVOX_TESTS_BENCH_MEASURE_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/mesh/mesh.h"
#include "tests/bench/arguments.h"

namespace latvox {

struct Measurement {
  uint64_t triangles = 0, voxels = 0;
  std::string simd;                                // kernels, or Arguments::peer
  std::string digest;                              // empty for another program
  double read_milliseconds = 0;                    // to make the mesh, or to read its file; the caller sets it
  std::vector<double> milliseconds;                // of each repetition, ascending: valid mesh to bricks, in memory
  std::vector<double> processor_milliseconds;      // of all threads, ascending
  std::optional<double> first_brick_milliseconds;  // from the same start to the first tile; minimum
  std::optional<double> cancel_milliseconds;       // see Arguments::cancel; from Cancel to the last thread's stop, most
  uint64_t peak_rss_bytes = 0;                     // of the process, once the mesh was loaded
  std::optional<uint64_t> job_peak_bytes;          // beyond the memory held before the first repetition, mesh included
};

// Runs in an arena of arguments.threads threads, which start before the clock. A job takes over its mesh, so each
// repetition gets a copy, made before the clock. With `last_use`, the last one gets the mesh itself. Errors: those of
// ForceSimd, ResolveGrid and VoxelizeJob.
absl::StatusOr<Measurement> Measure(const Arguments& arguments, TriangleMesh& mesh, bool last_use);

}  // namespace latvox

#endif  // LATVOX_TESTS_BENCH_MEASURE_H_
