#include "core/walk/steps.h"

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <map>
#include <utility>

namespace latvox {
namespace {

//   axes   of planes, rows and bits
RowSteps Arrange(const std::vector<Frame>& frames, const std::array<size_t, 3>& axes) {
  RowSteps steps;
  std::map<std::pair<int32_t, int32_t>, std::vector<int32_t>> bits;
  for (const Frame& frame : frames) {
    Vec3i q{frame.q[axes[0]], frame.q[axes[1]], frame.q[axes[2]]};
    if (q[0] == 0 && q[1] == 0) {
      steps.along = true;  // q is primitive
      continue;
    }
    if (q[0] < 0 || (q[0] == 0 && q[1] < 0)) q = -q;
    bits[{q[0], q[1]}].push_back(q[2]);
  }
  for (auto& [row, of_row] : bits) {
    std::sort(of_row.begin(), of_row.end());
    for (const int32_t bit : of_row) {
      RowStep* const last = steps.between.empty() ? nullptr : &steps.between.back();
      if (last != nullptr && last->dp == row.first && last->dr == row.second && last->high + 1 == bit) {
        last->high = bit;
      } else {
        steps.between.push_back({row.first, row.second, bit, bit});
      }
    }
  }
  return steps;
}

// The farthest that a shortest walk from 0 to `goal` goes, per axis. The facet neighbors generate the lattice, so there
// is a walk.
Vec3i Detour(const std::vector<Frame>& frames, const Vec3i& goal) {
  std::map<Vec3i, Vec3i> from{{Vec3i{}, Vec3i{}}};
  std::deque<Vec3i> todo{Vec3i{}};
  while (!from.contains(goal)) {
    const Vec3i at = todo.front();
    todo.pop_front();
    for (const Frame& frame : frames) {
      for (const Vec3i& next : {at + frame.q, at - frame.q}) {
        if (from.emplace(next, at).second) todo.push_back(next);
      }
    }
  }
  Vec3i farthest{};
  for (Vec3i at = goal; at != Vec3i{}; at = from[at]) {
    for (size_t m = 0; m < 3; ++m) farthest[m] = std::max(farthest[m], std::abs(at[m]));
  }
  return farthest;
}

}  // namespace

WalkSteps MakeWalkSteps(const std::vector<Frame>& frames) {
  WalkSteps steps{{}, {}, Arrange(frames, {0, 1, 2}), Arrange(frames, {2, 0, 1})};
  for (const Frame& frame : frames) {
    for (size_t m = 0; m < 3; ++m) steps.reach[m] = std::max(steps.reach[m], std::abs(frame.q[m]));
  }
  for (size_t axis = 0; axis < 3; ++axis) {
    Vec3i unit{};
    unit[axis] = 1;
    const bool is_step = std::any_of(frames.begin(), frames.end(),
                                     [&](const Frame& frame) { return frame.q == unit || frame.q == -unit; });
    if (is_step) continue;
    const Vec3i detour = Detour(frames, unit);
    for (size_t m = 0; m < 3; ++m) steps.slack[m] = std::max(steps.slack[m], detour[m]);
  }
  return steps;
}

}  // namespace latvox
