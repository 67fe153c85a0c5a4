// The steps of a walk between k-neighbors, arranged for rows of bits.
#ifndef LATVOX_CORE_WALK_STEPS_H_
#define LATVOX_CORE_WALK_STEPS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/lattice/frame.h"

namespace latvox {

// Steps from a point of a row to consecutive points of another row: from bit b of row (p, r) to the bits b + low ..
// b + high of row (p + dp, r + dr). The first of dp and dr that is not 0 is positive.
struct RowStep {
  int32_t dp, dr, low, high;
};

// All steps +-q, for rows in planes.
struct RowSteps {
  std::vector<RowStep> between;  // different rows; one of each pair +-q
  bool along = false;            // whether a step leads to the next bit of a row
};

struct WalkSteps {
  Vec3i reach;  // per axis, the longest step
  // Any two points of a box without walls are connected within this distance of the box, per axis. It is 0 if the
  // lattice's basis vectors are steps.
  Vec3i slack;
  RowSteps along_k;   // for planes along i, rows along j, bits along k
  RowSteps across_k;  // for planes along k, rows along i, bits along j
};

//   frames   of N_k
WalkSteps MakeWalkSteps(const std::vector<Frame>& frames);

}  // namespace latvox

#endif  // LATVOX_CORE_WALK_STEPS_H_
