// The lattice points of a tile that have certain labels.
#ifndef LATVOX_CORE_BRICK_LABEL_ROWS_H_
#define LATVOX_CORE_BRICK_LABEL_ROWS_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/bytes_of.h"
#include "core/brick/label_runs.h"

namespace latvox {

// One bit for each point and label. Most labels are nowhere in a tile, and cost nothing there. A thread reuses it from
// tile to tile.
class LabelRows {
 public:
  // Sets the points of a tile.
  //   labels   few
  //   runs     not empty
  void Set(std::span<const uint32_t> labels, const LabelRuns& runs) {
    found_.fill({});  // of other labels, maybe
    rows_.resize(labels.size(), std::vector<uint64_t>(kRows));
    is_present_.resize(labels.size());
    for (size_t n = 0; n < labels.size(); ++n) {
      if (is_present_[n] != 0) std::ranges::fill(rows_[n], 0);
      is_present_[n] = 0;
    }
    for (size_t row = 0; row < kRows; ++row) {
      const LabelRun* run = runs.Find(row, 0);
      for (uint32_t k = 0; k < 64; k = runs.EndOf(row, run++)) {
        if (run->label == kNoLabel) continue;
        const size_t place = PlaceOf(run->label, labels);
        if (place == labels.size()) continue;
        is_present_[place] = 1;
        rows_[place][row] |= Bits(k, runs.EndOf(row, run));
      }
    }
  }

  // The points with the n-th label: bit k of row (i << 6 | j).
  std::span<const uint64_t> Of(size_t n) const { return rows_[n]; }

  // Whether any point has the n-th label.
  bool Has(size_t n) const { return is_present_[n] != 0; }

  size_t Bytes() const { return rows_.size() * (kRows * sizeof(uint64_t)) + BytesOf(is_present_); }

 private:
  static constexpr size_t kRows = size_t{1} << 12;

  struct Found {
    uint32_t label = kNoLabel;
    size_t place = 0;
  };

  // The place of a label among these; their number if it is not there. Runs have few labels in turn, and a search among
  // all for each run took a fifth of a job's time.
  size_t PlaceOf(uint32_t label, std::span<const uint32_t> labels) {
    Found& found = found_[label % found_.size()];
    if (found.label != label) found = {label, static_cast<size_t>(std::ranges::find(labels, label) - labels.begin())};
    return found.place;
  }

  // The bits from `first` up to `end`, which is above it.
  static uint64_t Bits(uint32_t first, uint32_t end) { return ~uint64_t{0} >> (64 - (end - first)) << first; }

  std::array<Found, 32> found_;  // by the last bits of the label
  std::vector<std::vector<uint64_t>> rows_;
  std::vector<uint8_t> is_present_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_BRICK_LABEL_ROWS_H_
