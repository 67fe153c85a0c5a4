#include "core/solid/closed_rows.h"

#include <algorithm>
#include <array>
#include <bit>

#include "core/solid/tile_crossings.h"

namespace latvox {
namespace {

// The points `first` .. 63 of a row.
constexpr uint64_t From(int32_t first) { return ~uint64_t{0} << first; }

// Bit k: whether an odd number of the bits up to k are set.
constexpr uint64_t RunningParity(uint64_t bits) {
  for (int shift = 1; shift < 64; shift *= 2) bits ^= bits << shift;
  return bits;
}

}  // namespace

// For kParity, rows mark the changes of parity; for other rules, possible changes of the sum.
inline void ClosedRows::AddToRow(InteriorRule rule, size_t row, int32_t k, int32_t turn, InteriorRows& rows) {
  const uint64_t bit = uint64_t{1} << k;
  if (rule == InteriorRule::kParity) {
    rows.rows_[row] ^= bit;
  } else {
    rows.rows_[row] |= bit;
    rows.turns_[row * kTileSide + static_cast<size_t>(k)] += turn;
  }
}

void ClosedRows::Find(const SnappedMesh& mesh, InteriorRule rule, const Vec3i& low, int32_t at_corner,
                      std::span<const uint32_t> triangles, StopSignal stop, InteriorRows& rows) {
  std::fill(rows.rows_.begin(), rows.rows_.end(), triangles.empty() && IsInside(rule, at_corner) ? From(0) : 0);
  if (triangles.empty()) return;
  std::fill(rows.starts_.begin(), rows.starts_.end(), 0);
  if (rule != InteriorRule::kParity) rows.turns_.resize(InteriorRows::kRows * kTileSide);
  std::array<int32_t, kTileSide> along_i{};
  along_i[0] = at_corner;
  for (const uint32_t t : triangles) {
    if (stop.Stopped()) return;
    // Until they are finished, starts hold the change at each point of the sums along j.
    ForEachTileCrossing(
        mesh.TriangleAt(t), low, [&](size_t i, int32_t turn) { along_i[i] += turn; },
        [&](size_t i, int32_t j, int32_t turn) { rows.starts_[i * kTileSide + static_cast<size_t>(j)] += turn; },
        [&](size_t row, int32_t k, int32_t turn) { AddToRow(rule, row, k, turn, rows); });
  }
  FinishStarts(along_i, rows);
  FinishRows(rule, rows);
}

void ClosedRows::FinishStarts(const std::array<int32_t, kTileSide>& along_i, InteriorRows& rows) {
  int32_t at_i = 0;
  for (size_t i = 0; i < kTileSide; ++i) {
    at_i += along_i[i];
    int32_t at_j = at_i;
    for (size_t j = 0; j < kTileSide; ++j) {
      int32_t& start = rows.starts_[i * kTileSide + j];
      start = at_j += start;
    }
  }
}

void ClosedRows::FinishRows(InteriorRule rule, InteriorRows& rows) {
  for (size_t row = 0; row < InteriorRows::kRows; ++row) {
    const uint64_t changes = rows.rows_[row];
    const bool starts_inside = IsInside(rule, rows.starts_[row]);
    if (changes == 0 || rule == InteriorRule::kParity) {
      rows.rows_[row] = RunningParity(changes) ^ (starts_inside ? From(0) : 0);
    } else {
      rows.rows_[row] = SumRow(rule, changes, rows.starts_[row], &rows.turns_[row * kTileSide]);
    }
  }
}

// Clears the turns that it reads.
uint64_t ClosedRows::SumRow(InteriorRule rule, uint64_t changes, int32_t sum, int32_t* turns) {
  uint64_t inside = IsInside(rule, sum) ? From(0) : 0;
  for (; changes != 0; changes &= changes - 1) {
    const int k = std::countr_zero(changes);
    const bool was_inside = IsInside(rule, sum);
    sum += turns[k];
    turns[k] = 0;
    if (IsInside(rule, sum) != was_inside) inside ^= From(k);
  }
  return inside;
}

}  // namespace latvox
