#include "client/tool/output/hollows.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "client/tool/output/depth_blur.h"
#include "client/tool/output/share.h"

namespace latvox::client {
namespace {

// Returns the share of the sky that surroundings of this slope hide. Low ones hide nothing.
float HiddenBy(float slope) { return ShareOf(slope / std::sqrt(1 + slope * slope), 0.08F, 1); }

}  // namespace

Hollows::Hollows(int wide) : wide_(wide), reach_(0.07F * static_cast<float>(wide)) {
  for (size_t phase = 0; phase < kPhases; ++phase) {
    float distance = reach_;
    for (Ring& ring : rings_[phase]) {
      ring.inverse = 1 / distance;
      for (size_t d = 0; d < kDirections; ++d) {
        const float angle = (static_cast<float>(d) + static_cast<float>(phase) / kPhases) *
                            (2 * std::numbers::pi_v<float> / kDirections);
        ring.dx[d] = static_cast<int>(std::lround(std::cos(angle) * distance));
        ring.dy[d] = static_cast<int>(std::lround(std::sin(angle) * distance));
        ring.offset[d] = ring.dy[d] * wide + ring.dx[d];
        ring.right[d] = static_cast<float>(ring.dx[d]);
        ring.down[d] = static_cast<float>(ring.dy[d]);
      }
      distance *= 0.55F;
    }
  }
}

// The hidden share grows with the slope, so each direction needs only the root of its steepest rise. Rises beyond
// `reach_` fade out, and are rare. The compiler makes vectors of the directions.
float Hollows::Share(const std::vector<float>& depth, int x, int y, const std::array<float, 3>& normal) const {
  const float* const sample = &depth[static_cast<size_t>(y) * static_cast<size_t>(wide_) + static_cast<size_t>(x)];
  const float here = *sample, z = std::max(normal[2], 0.3F), right = normal[0] / z, down = normal[1] / z;
  Heights steepest{}, faded{};
  for (const Ring& ring : rings_[static_cast<size_t>(x % 2 + 2 * (y % 2))]) {
    const Heights there = Around(sample, x, y, ring);
    Heights rise;
    int beyond = 0;
    for (size_t d = 0; d < kDirections; ++d) {
      rise[d] = there[d] - here + (right * ring.right[d] - down * ring.down[d]);
      beyond |= static_cast<int>(rise[d] > reach_);
    }
    for (size_t d = 0; d < kDirections && beyond != 0; ++d) {
      if (rise[d] <= reach_) continue;
      faded[d] = std::max(faded[d], HiddenBy(rise[d] * ring.inverse) * ShareOf(rise[d], 3 * reach_, reach_));
      rise[d] = 0;
    }
    for (size_t d = 0; d < kDirections; ++d) steepest[d] = std::max(steepest[d], rise[d] * ring.inverse);
  }
  float sum = 0;
  for (size_t d = 0; d < kDirections; ++d) sum += std::max(faded[d], HiddenBy(steepest[d]));
  return sum / kDirections * ShareOf(normal[2], 0.1F, 0.5F);
}

// Returns the depths at the taps around a sample.
Hollows::Heights Hollows::Around(const float* sample, int x, int y, const Ring& ring) const {
  Heights there;
  const int margin = static_cast<int>(reach_) + 1;
  if (std::min(x, y) >= margin && std::max(x, y) < wide_ - margin) {
    for (size_t d = 0; d < kDirections; ++d) there[d] = sample[ring.offset[d]];
    return there;
  }
  for (size_t d = 0; d < kDirections; ++d) {
    const int sx = x + ring.dx[d], sy = y + ring.dy[d];
    const bool known = sx >= 0 && sy >= 0 && sx < wide_ && sy < wide_;
    there[d] = known ? sample[ring.offset[d]] : kNoDepth;
  }
  return there;
}

}  // namespace latvox::client
