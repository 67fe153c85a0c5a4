#include "client/output/depth_blur.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace latvox::client {
namespace {

// Along rows, or across them.
void Blur(const std::vector<float>& in, int wide, int radius, bool across, std::vector<float>& out) {
  const float edge = 3.0F * static_cast<float>(radius);
  const std::ptrdiff_t step = across ? 1 : wide;
  tbb::parallel_for(0, wide, [&](int y) {
    for (int x = 0; x < wide; ++x) {
      const auto at = static_cast<std::ptrdiff_t>(y) * wide + x;
      const float here = in[static_cast<size_t>(at)];
      if (here == kNoDepth) continue;
      const int along = across ? x : y;
      float sum = 0, weight = 0;
      for (int d = std::max(-radius, -along), last = std::min(radius, wide - 1 - along); d <= last; ++d) {
        const float there = in[static_cast<size_t>(at + d * step)];
        if (!(std::abs(there - here) < edge)) continue;
        sum += there;
        weight += 1;
      }
      out[static_cast<size_t>(at)] = sum / weight;
    }
  });
}

}  // namespace

std::vector<float> SmoothDepth(const std::vector<float>& depth, int wide, int radius) {
  std::vector<float> out = depth, in;
  for (const bool across : {true, false, true, false}) {
    in = out;
    Blur(in, wide, radius, across, out);
  }
  return out;
}

}  // namespace latvox::client
