// How long the algorithms take, on one thread (thesis section 5.4, figures 5.16 to 5.21).
#ifndef LATVOX_TESTS_THESIS_TIMING_H_
#define LATVOX_TESTS_THESIS_TIMING_H_

#include "core/request/algorithm.h"
#include "tests/thesis/experiment.h"

namespace latvox::thesis {

struct Timing {
  uint64_t voxels = 0;
  double seconds = 0;        // of the library's call: snap, voxelize, deliver a sparse set
  double fresh_seconds = 0;  // of the exact algorithm's call if core keeps no memory between calls; else 0
  // The thesis's algorithms into an array of bits, as in the thesis; 0 for the exact algorithm.
  uint64_t array_voxels = 0;
  double array_seconds = 0;
  double scan_seconds = 0;  // of array_seconds: the incremental algorithms' triangles without their seams
};

// Measures processor time, like the thesis, so that other processes disturb it little. Takes the least of several runs.
// Uses the calling thread alone.
Timing Time(const TriangleMesh& mesh, const Experiment& experiment, Algorithm algorithm);

}  // namespace latvox::thesis

#endif  // LATVOX_TESTS_THESIS_TIMING_H_
