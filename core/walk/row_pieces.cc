#include "core/walk/row_pieces.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <numeric>

namespace latvox {
namespace {

bool IsStraight(const RowStep& step) { return step.dp == 0 && step.dr == 1 && step.low <= 0 && step.high >= 0; }

// Whether each step across a plane and a row is also a step across the row alone, then one across the plane alone, and
// the reverse.
bool HasWaysAround(const RowStep& step, const RowSteps& steps) {
  const auto crosses_plane = [&](const RowStep& other) {
    return other.dp == step.dp && other.dr == 0 && other.low <= step.low && other.high >= step.high;
  };
  return step.dp != 0 && std::abs(step.dr) == 1 && std::ranges::any_of(steps.between, IsStraight) &&
         std::ranges::any_of(steps.between, crosses_plane);
}

// Calls f with the place of each bit, ascending.
template <class F>
void ForEachBit(WideRow row, F&& f) {
  for (auto word = static_cast<uint64_t>(row); word != 0; word &= word - 1) f(std::countr_zero(word));
  for (auto word = static_cast<uint64_t>(row >> 64); word != 0; word &= word - 1) f(64 + std::countr_zero(word));
}

// Writes the runs of a row, and returns their number. Rows have a bit to spare, so the end of a run is a bit, too.
uint32_t ListRow(WideRow row, bool along, FreeRun* runs) {
  if (!along) {
    uint32_t count = 0;
    ForEachBit(row, [&](int32_t bit) { runs[count++] = {bit, bit, 0}; });
    return count;
  }
  std::array<int32_t, 2 * RowPieces::kMostRuns> ends;  // the first point of each run, and the one after its last
  size_t count = 0;
  ForEachBit(row ^ row << 1, [&](int32_t bit) { ends[count++] = bit; });
  for (size_t n = 0; n < count; n += 2) runs[n / 2] = {ends[n], ends[n + 1] - 1, 0};
  return static_cast<uint32_t>(count / 2);
}

// Whether the step leads from one of these points to one of those.
bool Leads(WideRow from, WideRow to, const RowStep& step) {
  if (from == 0 || to == 0) return false;
  if (step.low == -1 && step.high == 1) return ((from >> 1 | from | from << 1) & to) != 0;  // as most do
  for (int32_t by = step.low; by <= step.high; ++by) {
    if (((by < 0 ? from >> -by : from << by) & to) != 0) return true;
  }
  return false;
}

}  // namespace

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
inline void RowPieces::UniteRows(const RunRange& row, const RunRange& other, const RowStep& step) {
  const FreeRun* const runs = runs_.data();
  uint32_t first = other.first;
  for (uint32_t a = row.first; a < row.end; ++a) {
    const int32_t low = runs[a].first + step.low, high = runs[a].last + step.high;
    while (first < other.end && runs[first].last < low) ++first;
    for (uint32_t b = first; b < other.end && runs[b].first <= high; ++b) {
      if (parents_[a] != parents_[b]) Unite(a, b);
    }
  }
}

// Unites the runs of two rows that are equal.
inline void RowPieces::UnitePairs(const RunRange& row, const RunRange& other) {
  for (uint32_t a = row.first, b = other.first; a < row.end; ++a, ++b) {
    if (parents_[a] != parents_[b]) Unite(a, b);
  }
}

// Returns the rows of a plane, one bit each, whose step may add a connection. Two rows that both repeat have nothing to
// add to the rows before them. A step with two ways around adds something only where a wall blocks both: where both
// rows differ from the rows beside them on that side.
WideRow RowPieces::RowsToUnite(size_t plane, size_t rows_per_plane, const RowStep& step, bool has_ways_around) const {
  const WideRow here = changed_[plane], there = changed_[plane + static_cast<size_t>(step.dp)];
  const int32_t first = std::max(-step.dr, 0), rows = static_cast<int32_t>(rows_per_plane) - std::abs(step.dr);
  if (rows <= 0) return 0;
  const WideRow all = FirstBits(rows) << first;
  if (has_ways_around) return (step.dr > 0 ? (here & there) >> 1 : here & there) & all;
  return (here | (step.dr > 0 ? there >> step.dr : there << -step.dr) | WideRow{1} << first) & all;
}

// Near a surface, most rows repeat the row before them. If a step leads straight from one to the other, their runs are
// united one by one.
void RowPieces::Find(std::span<const WideRow> free, int32_t rows_per_plane, const RowSteps& steps) {
  const auto per_plane = static_cast<size_t>(rows_per_plane), planes = free.size() / per_plane;
  ListRuns(free, per_plane, steps);
  for (const RowStep& step : steps.between) {
    const ptrdiff_t ahead = static_cast<ptrdiff_t>(step.dp) * rows_per_plane + step.dr;
    const bool has_ways_around = HasWaysAround(step, steps);
    // A step of one bit at most does not lead over a wall between two runs.
    const bool pairs_suffice = steps.along && step.low >= -1 && step.low <= 0 && step.high >= 0 && step.high <= 1;
    for (size_t plane = 0; plane + static_cast<size_t>(step.dp) < planes; ++plane) {
      ForEachBit(RowsToUnite(plane, per_plane, step, has_ways_around), [&](int32_t in_plane) {
        const size_t row = plane * per_plane + static_cast<size_t>(in_plane);
        const auto other = static_cast<size_t>(static_cast<ptrdiff_t>(row) + ahead);
        if (has_ways_around) {
          const auto dr = static_cast<size_t>(step.dr);  // wraps around, as size_t does
          if (!Leads(free[row] & ~free[row + dr], free[other] & ~free[other - dr], step)) return;
        }
        if (pairs_suffice && free[row] == free[other]) {
          UnitePairs(ranges_[row], ranges_[other]);
        } else {
          UniteRows(ranges_[row], ranges_[other], step);
        }
      });
    }
  }
  count_ = 0;
  for (uint32_t run = 0; run < parents_.size(); ++run) {  // a root comes before the rest of its piece
    runs_[run].piece = parents_[run] == run ? count_++ : runs_[Root(run)].piece;
  }
}

void RowPieces::ListRuns(std::span<const WideRow> free, size_t rows_per_plane, const RowSteps& steps) {
  const bool has_straight = std::ranges::any_of(steps.between, IsStraight);
  ranges_.resize(free.size());
  changed_.clear();
  repeats_.assign(free.size(), 0);
  uint32_t end = 0;
  for (size_t plane = 0; plane < free.size(); plane += rows_per_plane) {
    WideRow changed = 0;
    for (size_t n = plane; n < plane + rows_per_plane; ++n) {
      if (has_straight && n != plane && free[n] == free[n - 1]) {
        repeats_[n] = 1;
        ranges_[n] = ranges_[n - 1];
        continue;
      }
      changed |= WideRow{1} << (n - plane);
      if (runs_.size() < end + kMostRuns) runs_.resize(2 * runs_.size() + kMostRuns);
      const uint32_t first = end;
      end += ListRow(free[n], steps.along, &runs_[first]);
      ranges_[n] = {first, end};
    }
    changed_.push_back(changed);
  }
  parents_.resize(end);
  std::iota(parents_.begin(), parents_.end(), 0U);
}

uint32_t RowPieces::PieceAt(size_t row, int32_t bit) const {
  const std::span<const FreeRun> runs = RunsOf(row);
  return std::find_if(runs.begin(), runs.end(), [bit](const FreeRun& run) { return bit <= run.last; })->piece;
}

}  // namespace latvox
