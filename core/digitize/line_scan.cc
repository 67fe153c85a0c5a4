#include "core/digitize/line_scan.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace latvox {

int32_t NarrowExtent(const std::vector<ScanFrame>& frames) {
  int32_t most = 1;
  for (const ScanFrame& scan : frames) {
    for (const Vec3i& u : scan.frame.u) most = std::max(most, std::abs(u[0]) + std::abs(u[1]) + std::abs(u[2]));
  }
  return std::min(1 << 14, static_cast<int32_t>(std::sqrt(((1 << 30) - 1) / most)));
}

FrameTable::FrameTable(const std::vector<ScanFrame>& frames, const IndexBox& box) : size(frames.size()) {
  for (size_t n = 0; n < size; ++n) {
    const Frame& frame = frames[n].frame;
    for (size_t m = 0; m < 3; ++m) {
      q[m].of[n] = frame.q[m];
      reach = std::max(reach, std::abs(frame.q[m]));
      for (size_t row = 0; row < 3; ++row) r[row][m].of[n] = frame.r[row][m];
      for (size_t column = 0; column < 2; ++column) u[column][m].of[n] = frame.u[column][m];
    }
    for (size_t axis = 0; axis < 2; ++axis) {
      const auto lines = crossing_internal::RangeOver(box, frame.r[axis]);
      first[axis].of[n] = static_cast<int32_t>(lines.first);
      last[axis].of[n] = static_cast<int32_t>(lines.last);
      rim[axis].of[n] = static_cast<int32_t>(axis == 0 ? frames[n].reach_a : frames[n].reach_b) * kLatticeUnit / 2;
    }
    hull_size = std::max(hull_size, frames[n].hull.size());
    for (size_t h = 0; h < frames[n].hull.size(); ++h) {
      for (size_t axis = 0; axis < 2; ++axis) hull[h][axis].of[n] = static_cast<int32_t>(frames[n].hull[h][axis]);
    }
  }
}

}  // namespace latvox
