#include "core/walk/row_pieces.h"

#include <algorithm>

namespace latvox {

void RowPieces::Find(std::span<const WideRow> free, int32_t rows_per_plane, const RowSteps& steps) {
  runs_.clear();
  starts_.assign(1, 0);
  for (WideRow row : free) {
    while (row != 0) {
      const int32_t first = LowestBit(row);
      const WideRow ended = ~(row >> first);
      const int32_t length = steps.along ? LowestBit(ended) : 1;
      runs_.push_back({first, first + length - 1, 0});
      row &= ~(FirstBits(length) << first);
    }
    starts_.push_back(static_cast<uint32_t>(runs_.size()));
  }
  parents_.resize(runs_.size());
  for (uint32_t run = 0; run < parents_.size(); ++run) parents_[run] = run;
  const auto per_plane = static_cast<size_t>(rows_per_plane), planes = free.size() / per_plane;
  for (const RowStep& step : steps.between) {
    for (size_t plane = 0; plane + static_cast<size_t>(step.dp) < planes; ++plane) {
      const auto first = static_cast<size_t>(std::max(-step.dr, 0));
      const auto end = static_cast<size_t>(std::max(rows_per_plane - std::max(step.dr, 0), 0));
      for (size_t row = first; row < end; ++row) {
        const size_t at = plane * per_plane + row;
        const auto ahead = static_cast<ptrdiff_t>(step.dp) * rows_per_plane + step.dr;
        UniteRows(at, static_cast<size_t>(static_cast<ptrdiff_t>(at) + ahead), step);
      }
    }
  }
  count_ = 0;
  for (uint32_t run = 0; run < parents_.size(); ++run) {  // a root comes before the rest of its piece
    runs_[run].piece = parents_[run] == run ? count_++ : runs_[Root(run)].piece;
  }
}

uint32_t RowPieces::PieceAt(size_t row, int32_t bit) const {
  const std::span<const FreeRun> runs = RunsOf(row);
  return std::find_if(runs.begin(), runs.end(), [bit](const FreeRun& run) { return bit <= run.last; })->piece;
}

uint32_t RowPieces::Root(uint32_t run) {
  while (parents_[run] != run) run = parents_[run] = parents_[parents_[run]];
  return run;
}

void RowPieces::Unite(uint32_t a, uint32_t b) {
  if (parents_[a] == parents_[b]) return;
  a = Root(a);
  b = Root(b);
  parents_[std::max(a, b)] = std::min(a, b);
}

// Unites runs where a step leads from one to the other.
void RowPieces::UniteRows(size_t row, size_t other, const RowStep& step) {
  uint32_t first = starts_[other];
  const uint32_t end = starts_[other + 1];
  for (uint32_t a = starts_[row]; a < starts_[row + 1]; ++a) {
    const int32_t low = runs_[a].first + step.low, high = runs_[a].last + step.high;
    while (first < end && runs_[first].last < low) ++first;
    for (uint32_t b = first; b < end && runs_[b].first <= high; ++b) Unite(a, b);
  }
}

}  // namespace latvox
