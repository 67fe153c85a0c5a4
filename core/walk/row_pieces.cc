#include "core/walk/row_pieces.h"

#include <algorithm>

namespace latvox {

inline uint32_t RowPieces::Root(uint32_t run) {
  while (parents_[run] != run) run = parents_[run] = parents_[parents_[run]];
  return run;
}

void RowPieces::Unite(uint32_t a, uint32_t b) {
  a = Root(a);
  b = Root(b);
  parents_[std::max(a, b)] = std::min(a, b);
}

// Unites runs where a step leads from one to the other.
inline void RowPieces::UniteRows(size_t row, size_t other, const RowStep& step) {
  const FreeRun* const runs = runs_.data();
  uint32_t first = starts_[other];
  const uint32_t end = starts_[other + 1], end_of_row = starts_[row + 1];
  for (uint32_t a = starts_[row]; a < end_of_row; ++a) {
    const int32_t low = runs[a].first + step.low, high = runs[a].last + step.high;
    while (first < end && runs[first].last < low) ++first;
    for (uint32_t b = first; b < end && runs[b].first <= high; ++b) {
      if (parents_[a] != parents_[b]) Unite(a, b);
    }
  }
}

// Near a surface, most rows repeat the row before them. If a step leads straight from one to the other, their runs are
// united one by one. Two rows that both repeat have nothing to add to the rows before them.
void RowPieces::Find(std::span<const WideRow> free, int32_t rows_per_plane, const RowSteps& steps) {
  const auto per_plane = static_cast<size_t>(rows_per_plane), planes = free.size() / per_plane;
  ListRuns(free, per_plane, steps);
  for (const RowStep& step : steps.between) {
    const auto first = static_cast<size_t>(std::max(-step.dr, 0));
    const auto end = static_cast<size_t>(std::max(rows_per_plane - std::max(step.dr, 0), 0));
    const ptrdiff_t ahead = static_cast<ptrdiff_t>(step.dp) * rows_per_plane + step.dr;
    for (size_t plane = 0; plane + static_cast<size_t>(step.dp) < planes; ++plane) {
      for (size_t row = plane * per_plane + first; row < plane * per_plane + end; ++row) {
        const auto other = static_cast<size_t>(static_cast<ptrdiff_t>(row) + ahead);
        if (repeats_[row] != 0 && repeats_[other] != 0 && row != plane * per_plane + first) continue;
        UniteRows(row, other, step);
      }
    }
  }
  count_ = 0;
  for (uint32_t run = 0; run < parents_.size(); ++run) {  // a root comes before the rest of its piece
    runs_[run].piece = parents_[run] == run ? count_++ : runs_[Root(run)].piece;
  }
}

void RowPieces::ListRuns(std::span<const WideRow> free, size_t rows_per_plane, const RowSteps& steps) {
  const bool has_straight = std::any_of(steps.between.begin(), steps.between.end(), [](const RowStep& step) {
    return step.dp == 0 && step.dr == 1 && step.low <= 0 && step.high >= 0;
  });
  runs_.clear();
  parents_.clear();
  starts_.assign(1, 0);
  repeats_.assign(free.size(), 0);
  for (size_t n = 0; n < free.size(); ++n) {
    WideRow row = free[n];
    if (has_straight && n % rows_per_plane != 0 && row == free[n - 1]) {
      repeats_[n] = 1;
      for (uint32_t run = starts_[n - 1]; run < starts_[n]; ++run) {
        runs_.push_back(FreeRun(runs_[run]));
        parents_.push_back(uint32_t{parents_[run]});
      }
    } else {
      while (row != 0) {
        const int32_t first = LowestBit(row), length = steps.along ? LowestBit(~(row >> first)) : 1;
        parents_.push_back(static_cast<uint32_t>(runs_.size()));
        runs_.push_back({first, first + length - 1, 0});
        row &= ~(FirstBits(length) << first);
      }
    }
    starts_.push_back(static_cast<uint32_t>(runs_.size()));
  }
}

uint32_t RowPieces::PieceAt(size_t row, int32_t bit) const {
  const std::span<const FreeRun> runs = RunsOf(row);
  return std::find_if(runs.begin(), runs.end(), [bit](const FreeRun& run) { return bit <= run.last; })->piece;
}

}  // namespace latvox
