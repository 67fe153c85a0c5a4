// The labels of a tile's lattice points, in runs along k.
#ifndef LATVOX_CORE_BRICK_LABEL_RUNS_H_
#define LATVOX_CORE_BRICK_LABEL_RUNS_H_

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace latvox {

// A point without a label has this number, and no label has it.
inline constexpr uint32_t kNoLabel = std::numeric_limits<uint32_t>::max();

struct LabelRun {
  uint32_t first_k;  // in the tile; the run ends where the row's next one begins
  uint32_t label;
};

struct LabelRuns {
  // The runs of row (i << 6 | j) begin at starts[row], the first one at k = 0, and end at starts[row + 1]. Without
  // starts, the only run is that of all rows.
  std::vector<uint32_t> starts = {};
  std::vector<LabelRun> runs = {};  // empty: the tile is not labeled

  bool empty() const { return runs.empty(); }
  void clear() {
    starts.clear();
    runs.clear();
  }

  // The run of a point.
  const LabelRun* Find(size_t row, uint32_t k) const {
    if (starts.empty()) return runs.data();
    const LabelRun* run = &runs[starts[row]];
    const LabelRun* const end = runs.data() + starts[row + 1];
    while (run + 1 != end && run[1].first_k <= k) ++run;
    return run;
  }

  // Where the run of a row ends.
  uint32_t EndOf(size_t row, const LabelRun* run) const {
    const bool is_last = starts.empty() || run + 1 == runs.data() + starts[row + 1];
    return is_last ? 64 : run[1].first_k;
  }
};

}  // namespace latvox

#endif  // LATVOX_CORE_BRICK_LABEL_RUNS_H_
