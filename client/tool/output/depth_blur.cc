#include "client/tool/output/depth_blur.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

namespace latvox::client {
namespace {

// Averages along a line. Where all neighbors count, the average is a difference of two prefix sums, at a cost
// independent of the radius. The least and greatest depth of the blocks around tell whether all count.
class LineBlur {
 public:
  LineBlur(const std::vector<float>& in, size_t first, size_t step, int count, int radius)
      : radius_(radius),
        count_(count),
        edge_(3.0F * static_cast<float>(radius)),
        shift_(std::bit_width(static_cast<unsigned>(radius)) - 1) {
    const auto size = static_cast<size_t>(count);
    line_.resize(size);
    sums_.resize(size + 1);
    counts_.resize(size + 1);
    blocks_.resize((size >> shift_) + 1);
    for (size_t n = 0; n < size; ++n) {
      const float depth = line_[n] = in[first + n * step];
      const bool is_there = depth != kNoDepth;
      sums_[n + 1] = sums_[n] + (is_there ? double{depth} : 0);
      counts_[n + 1] = counts_[n] + is_there;
      if (!is_there) continue;
      Block& block = blocks_[n >> shift_];
      block.least = std::min(block.least, depth);
      block.most = std::max(block.most, depth);
    }
  }

  float At(int n) const {
    const float here = line_[static_cast<size_t>(n)];
    const int low = std::max(n - radius_, 0), high = std::min(n + radius_ + 1, count_);
    if (here == kNoDepth) return here;
    if (AllCount(here, low >> shift_, (high - 1) >> shift_)) {
      const auto from = static_cast<size_t>(low), to = static_cast<size_t>(high);
      return static_cast<float>((sums_[to] - sums_[from]) / (counts_[to] - counts_[from]));
    }
    double sum = 0;
    int weight = 0;
    for (int m = low; m < high; ++m) {
      const float there = line_[static_cast<size_t>(m)];
      if (!(std::abs(there - here) < edge_)) continue;
      sum += there;
      ++weight;
    }
    return static_cast<float>(sum / weight);
  }

 private:
  struct Block {
    float least = -kNoDepth, most = kNoDepth;
  };

  bool AllCount(float here, int first, int last) const {
    for (int n = first; n <= last; ++n) {
      const Block& block = blocks_[static_cast<size_t>(n)];
      if (here - block.least >= edge_ || block.most - here >= edge_) return false;
    }
    return true;
  }

  const int radius_, count_;
  const float edge_;
  const int shift_;  // a block has 2^shift_ samples
  std::vector<float> line_;
  std::vector<double> sums_;  // sums of the depths before a sample
  std::vector<int> counts_;   // numbers of depths before a sample
  std::vector<Block> blocks_;
};

// Blurs along rows, or along columns.
void Blur(int wide, int radius, bool across, std::vector<float>& depth) {
  tbb::parallel_for(0, wide, [&](int n) {
    const size_t step = across ? 1 : static_cast<size_t>(wide);
    const size_t first = static_cast<size_t>(n) * (across ? static_cast<size_t>(wide) : 1);
    const LineBlur line(depth, first, step, wide, radius);
    for (int m = 0; m < wide; ++m) depth[first + static_cast<size_t>(m) * step] = line.At(m);
  });
}

}  // namespace

std::vector<float> SmoothDepth(const std::vector<float>& depth, int wide, int radius) {
  std::vector<float> out = depth;
  for (const bool across : {true, false, true, false}) Blur(wide, radius, across, out);
  return out;
}

}  // namespace latvox::client
