#include "client/tool/output/depth_blur.h"

#include <oneapi/tbb/blocked_range.h>
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
  LineBlur(int count, int radius)
      : radius_(radius),
        count_(count),
        edge_(3.0F * static_cast<float>(radius)),
        shift_(std::bit_width(static_cast<unsigned>(radius)) - 1),
        line_(static_cast<size_t>(count)),
        sums_(static_cast<size_t>(count) + 1),
        counts_(static_cast<size_t>(count) + 1),
        blocks_((static_cast<size_t>(count) >> shift_) + 1) {}

  // Replaces the depths of a line by their averages.
  void Apply(float* line) {
    Read(line);
    if (counts_.back() == 0) return;
    first_ = last_ = -1;
    for (int n = 0; n < count_; ++n) line[n] = At(n);
  }

 private:
  struct Block {
    float least = -kNoDepth, most = kNoDepth;
  };

  void Read(const float* line) {
    std::ranges::fill(blocks_, Block());
    for (size_t n = 0; n < line_.size(); ++n) {
      const float depth = line_[n] = line[n];
      const bool is_there = depth != kNoDepth;
      sums_[n + 1] = sums_[n] + (is_there ? double{depth} : 0);
      counts_[n + 1] = counts_[n] + is_there;
      if (!is_there) continue;
      Block& block = blocks_[n >> shift_];
      block.least = std::min(block.least, depth);
      block.most = std::max(block.most, depth);
    }
  }

  float At(int n) {
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

  // Neighbors in the same block mostly have the same blocks around them.
  bool AllCount(float here, int first, int last) {
    if (first != first_ || last != last_) {
      first_ = first;
      last_ = last;
      around_ = {};
      for (int n = first; n <= last; ++n) {
        const Block& block = blocks_[static_cast<size_t>(n)];
        around_.least = std::min(around_.least, block.least);
        around_.most = std::max(around_.most, block.most);
      }
    }
    return here - around_.least < edge_ && around_.most - here < edge_;
  }

  const int radius_, count_;
  const float edge_;
  const int shift_;  // a block has 2^shift_ samples
  std::vector<float> line_;
  std::vector<double> sums_;  // sums of the depths before a sample
  std::vector<int> counts_;   // numbers of depths before a sample
  std::vector<Block> blocks_;
  int first_ = -1, last_ = -1;  // blocks
  Block around_;                // of them
};

void BlurRows(size_t wide, int radius, std::vector<float>& depth) {
  tbb::parallel_for(tbb::blocked_range<size_t>(0, wide), [&](const auto& rows) {
    LineBlur blur(static_cast<int>(wide), radius);
    for (size_t y = rows.begin(); y < rows.end(); ++y) blur.Apply(&depth[y * wide]);
  });
}

// Copies columns to lines and back, as many as lie in a line of the cache.
void BlurColumns(size_t wide, int radius, std::vector<float>& depth) {
  constexpr size_t kColumns = 16;
  tbb::parallel_for(size_t{0}, (wide + kColumns - 1) / kColumns, [&](size_t part) {
    const size_t first = part * kColumns, count = std::min(kColumns, wide - first);
    LineBlur blur(static_cast<int>(wide), radius);
    std::vector<float> lines(count * wide);
    for (size_t y = 0; y < wide; ++y) {
      for (size_t x = 0; x < count; ++x) lines[x * wide + y] = depth[y * wide + first + x];
    }
    for (size_t x = 0; x < count; ++x) blur.Apply(&lines[x * wide]);
    for (size_t y = 0; y < wide; ++y) {
      for (size_t x = 0; x < count; ++x) depth[y * wide + first + x] = lines[x * wide + y];
    }
  });
}

}  // namespace

std::vector<float> SmoothDepth(const std::vector<float>& depth, int wide, int radius) {
  std::vector<float> out = depth;
  for (int pass = 0; pass < 2; ++pass) {
    BlurRows(static_cast<size_t>(wide), radius, out);
    BlurColumns(static_cast<size_t>(wide), radius, out);
  }
  return out;
}

}  // namespace latvox::client
