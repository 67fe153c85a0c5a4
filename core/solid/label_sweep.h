// Which labels contain the points of a tile, along its rows.
#ifndef LATVOX_CORE_SOLID_LABEL_SWEEP_H_
#define LATVOX_CORE_SOLID_LABEL_SWEEP_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/bytes_of.h"
#include "core/brick/label_runs.h"
#include "core/request/solid.h"

namespace latvox {

// Keeps one sum of signed crossings for each label, and the labels that contain the point, ordered by rank. Sums go
// from the tile's lowest point along i, then along j, then along k. A row's changes are undone after it, so the cost
// of a row is that of its crossings, whatever the number of labels. A thread reuses it from tile to tile.
class LabelSweep {
 public:
  // Begins a tile.
  //   labels   the number of all labels; ranks are below it
  void Begin(InteriorRule rule, size_t labels);

  // A crossing on the way to the tile's lowest point.
  void AddStart(uint32_t rank, int32_t turn) { Push(0, 0, rank, turn, starts_); }
  // The sum of a label changes at a point of the line (i, 0, 0), (i, j, 0) or (row, k), row = i << 6 | j.
  void AddAlongI(size_t i, uint32_t rank, int32_t turn) { Push(0, i, rank, turn, along_i_); }
  void AddAlongJ(size_t i, size_t j, uint32_t rank, int32_t turn) { Push(i, j, rank, turn, along_j_); }
  void AddAlongK(size_t row, size_t k, uint32_t rank, int32_t turn) { Push(row, k, rank, turn, along_k_); }

  // Finds bit k of each row, and the label with the lowest rank that contains each point.
  //   numbers   the labels by rank
  void Finish(std::span<const uint32_t> numbers, std::span<uint64_t> rows, LabelRuns& labels);

  // Finds the same for one row alone, from its changes along k, and forgets these. Appends its runs.
  uint64_t FinishLine(std::span<const uint32_t> numbers, std::vector<LabelRun>& runs);

  // The number of crossings so far.
  size_t Size() const { return starts_.size() + along_i_.size() + along_j_.size() + along_k_.size(); }

  size_t Bytes() const {
    return BytesOf(starts_) + BytesOf(along_i_) + BytesOf(along_j_) + BytesOf(along_k_) + BytesOf(sorted_) +
           BytesOf(row_ends_) + BytesOf(places_) + BytesOf(present_) + BytesOf(sums_) + BytesOf(inside_);
  }

 private:
  // row << 24 + 7 | at << 24 | rank << 1 | whether the turn is +1. So changes ascend along the rows.
  using Change = uint64_t;
  using Changes = std::vector<Change>;
  static constexpr int kAtShift = 24, kRowShift = kAtShift + 7;
  static_assert(kMaxLabels << 1 <= size_t{1} << kAtShift);

  static void Push(size_t row, size_t at, uint32_t rank, int32_t turn, Changes& changes) {
    changes.push_back(uint64_t{row} << kRowShift | uint64_t{at} << kAtShift | uint64_t{rank} << 1 | (turn > 0 ? 1 : 0));
  }
  static size_t LineOf(Change change) { return static_cast<size_t>(change >> kAtShift); }
  static uint32_t AtOf(Change change) { return static_cast<uint32_t>(change >> kAtShift) & 127; }
  static uint32_t RankOf(Change change) { return static_cast<uint32_t>(change >> 1) & ((1 << (kAtShift - 1)) - 1); }

  void NumberLabels();
  void ForgetLabels();
  void SortRows();
  void Apply(Change change, int32_t sign);
  void Apply(std::span<const Change> changes, int32_t sign);
  uint32_t Top(std::span<const uint32_t> numbers) const;
  uint64_t FinishRow(std::span<const Change> changes, std::span<const uint32_t> numbers, std::vector<LabelRun>& runs);

  InteriorRule rule_ = InteriorRule::kParity;
  Changes starts_, along_i_, along_j_, along_k_, sorted_;
  std::vector<uint32_t> row_ends_;  // in sorted_
  std::vector<uint32_t> places_;    // of ranks, in present_; meaningful for these alone
  std::vector<uint32_t> present_;   // the ranks in this tile, ascending
  std::vector<int32_t> sums_;       // of these
  std::vector<uint64_t> inside_;    // of these, one bit each
};

}  // namespace latvox

#endif  // LATVOX_CORE_SOLID_LABEL_SWEEP_H_
