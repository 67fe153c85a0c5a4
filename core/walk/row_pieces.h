// The connected pieces of a box of lattice points, by runs of its rows.
#ifndef LATVOX_CORE_WALK_ROW_PIECES_H_
#define LATVOX_CORE_WALK_ROW_PIECES_H_

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/bytes_of.h"
#include "core/walk/steps.h"

namespace latvox {

// Points of a row, one bit each. A tile's row with its halo has more than 64.
using WideRow = unsigned __int128;

// The bits 0 .. count - 1. Precondition: 0 <= count < 128.
constexpr WideRow FirstBits(int32_t count) { return (WideRow{1} << count) - 1; }

// Returns the position of the lowest bit. Precondition: row != 0.
constexpr int32_t LowestBit(WideRow row) {
  const auto low = static_cast<uint64_t>(row);
  return low != 0 ? std::countr_zero(low) : 64 + std::countr_zero(static_cast<uint64_t>(row >> 64));
}

// Consecutive free points of a row.
struct FreeRun {
  int32_t first, last;
  uint32_t piece;
};

// Pieces are numbered in the order of their first runs. Rows are those of one plane after the other. Reuses its memory.
class RowPieces {
 public:
  static constexpr uint32_t kMostRuns = 128;  // of a row

  //   free   rows_per_plane < 128 rows for each plane; bits of points that a walk may enter
  void Find(std::span<const WideRow> free, int32_t rows_per_plane, const RowSteps& steps);

  uint32_t count() const { return count_; }
  size_t rows() const { return ranges_.size(); }
  // The runs of a row, ascending; single points if no step leads along rows.
  std::span<const FreeRun> RunsOf(size_t row) const {
    return {runs_.data() + ranges_[row].first, runs_.data() + ranges_[row].end};
  }
  // Whether a row has the runs and the pieces of the row before it in its plane. False says nothing.
  bool Repeats(size_t row) const { return repeats_[row] != 0; }
  // The same for all rows.
  std::span<const uint8_t> repeats() const { return repeats_; }
  // Returns the piece of a free point.
  uint32_t PieceAt(size_t row, int32_t bit) const;

  size_t Bytes() const {
    return BytesOf(runs_) + BytesOf(ranges_) + BytesOf(parents_) + BytesOf(repeats_) + BytesOf(changed_);
  }

 private:
  struct RunRange {
    uint32_t first, end;
  };
  uint32_t Root(uint32_t run);
  WideRow RowsToUnite(size_t plane, size_t rows_per_plane, const RowStep& step, bool has_ways_around) const;
  void Unite(uint32_t a, uint32_t b);
  void ListRuns(std::span<const WideRow> free, size_t rows_per_plane, const RowSteps& steps);
  void UniteRows(const RunRange& row, const RunRange& other, const RowStep& step);
  void UnitePairs(const RunRange& row, const RunRange& other);

  std::vector<FreeRun> runs_;      // as many as parents_; the others are meaningless
  std::vector<RunRange> ranges_;   // of rows; those that repeat share their runs
  std::vector<uint32_t> parents_;  // of runs: the root of a piece is its first run
  std::vector<uint8_t> repeats_;   // of rows: whether it is equal to the row before it in its plane, and united with it
  std::vector<WideRow> changed_;   // of planes: the rows that do not repeat, one bit each
  uint32_t count_ = 0;
};

}  // namespace latvox

#endif  // LATVOX_CORE_WALK_ROW_PIECES_H_
