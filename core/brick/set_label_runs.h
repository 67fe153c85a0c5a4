// The runs of a tile whose points have labels one by one.
#ifndef LATVOX_CORE_BRICK_SET_LABEL_RUNS_H_
#define LATVOX_CORE_BRICK_SET_LABEL_RUNS_H_

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/brick/label_runs.h"

namespace latvox {

//   of_points   the label of point (i, j, k) at i << 12 | j << 6 | k
inline void SetLabelRuns(std::span<const uint32_t> of_points, LabelRuns& labels) {
  labels.clear();
  for (size_t n = 0; n < of_points.size(); ++n) {
    const auto k = static_cast<uint32_t>(n % 64);
    if (k == 0) labels.starts.push_back(static_cast<uint32_t>(labels.runs.size()));
    if (k == 0 || of_points[n] != of_points[n - 1]) labels.runs.push_back({k, of_points[n]});
  }
  labels.starts.push_back(static_cast<uint32_t>(labels.runs.size()));
}

}  // namespace latvox

#endif  // LATVOX_CORE_BRICK_SET_LABEL_RUNS_H_
