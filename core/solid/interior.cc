#include "core/solid/interior.h"

#include <algorithm>
#include <array>
#include <bit>

#include "core/solid/axis_crossing.h"
#include "core/solid/line_crossings.h"
#include "core/solid/tile_crossings.h"

namespace latvox {
namespace {

// The points `first` .. 63 of a row.
constexpr uint64_t From(int32_t first) { return first >= kTileSide ? 0 : ~uint64_t{0} << first; }

// Bit k: whether an odd number of the bits up to k are set.
constexpr uint64_t RunningParity(uint64_t bits) {
  for (int shift = 1; shift < 64; shift *= 2) bits ^= bits << shift;
  return bits;
}

}  // namespace

class ClosedInterior : public Interior {
 public:
  ClosedInterior(const SnappedMesh& mesh, InteriorRule rule, const IndexBox& region, StopSignal stop)
      : mesh_(mesh),
        rule_(rule),
        stop_(stop),
        first_tile_(Shifted(region.min, kTileBits)),
        corners_(FindLineCrossings<kCornerBits>(mesh, region, stop)) {
    // Sums over whole lines are even, or 0 (for other rules than kParity), so no line affects the lines after it.
    sums_.reserve(corners_.size());
    int32_t sum = 0;
    for (const uint64_t corner : corners_) sums_.push_back(sum += LineCrossing::Turn(corner));
  }

  // It is the same for the whole cube, so a tile that meets the region decides.
  bool MayHold(const Vec3i& tile_ijk, int) const override {
    Vec3i tile;
    for (size_t m = 0; m < 3; ++m) tile[m] = std::max(tile_ijk[m], first_tile_[m]);
    return IsInside(rule_, SumAtCorner(tile));
  }

  void Find(const Vec3i& tile_ijk, std::span<const uint32_t> triangles, InteriorRows& rows) const override {
    const Vec3i low = tile_ijk * kTileSide;
    const int32_t at_corner = SumAtCorner(tile_ijk);
    std::fill(rows.rows_.begin(), rows.rows_.end(), triangles.empty() && IsInside(rule_, at_corner) ? From(0) : 0);
    if (triangles.empty()) return;
    std::fill(rows.starts_.begin(), rows.starts_.end(), 0);
    if (rule_ != InteriorRule::kParity) rows.turns_.resize(InteriorRows::kRows * kTileSide);
    std::array<int32_t, kTileSide> along_i{};
    along_i[0] = at_corner;
    for (const uint32_t t : triangles) {
      if (stop_.Stopped()) return;
      Add(mesh_.TriangleAt(t), low, along_i, rows);
    }
    FinishStarts(along_i, rows);
    FinishRows(rows);
  }

 private:
  int32_t SumAtCorner(const Vec3i& tile_ijk) const {
    const uint64_t end = LineCrossing::Least(tile_ijk[0], tile_ijk[1], tile_ijk[2] + 1);
    const auto after = std::lower_bound(corners_.begin(), corners_.end(), end);
    return after == corners_.begin() ? 0 : sums_[static_cast<size_t>(after - corners_.begin()) - 1];
  }

  // Until they are finished, starts hold the change at each point of the sums along j.
  void Add(const Triangle& triangle, const Vec3i& low, std::array<int32_t, kTileSide>& along_i,
           InteriorRows& rows) const {
    ForEachTileCrossing(
        triangle, low, [&](size_t i, int32_t turn) { along_i[i] += turn; },
        [&](size_t i, int32_t j, int32_t turn) { rows.starts_[i * kTileSide + static_cast<size_t>(j)] += turn; },
        [&](size_t row, int32_t k, int32_t turn) { AddToRow(row, k, turn, rows); });
  }

  // For kParity, rows mark the changes of parity; for other rules, possible changes of the sum.
  void AddToRow(size_t row, int32_t k, int32_t turn, InteriorRows& rows) const {
    const uint64_t bit = uint64_t{1} << k;
    if (rule_ == InteriorRule::kParity) {
      rows.rows_[row] ^= bit;
    } else {
      rows.rows_[row] |= bit;
      rows.turns_[row * kTileSide + static_cast<size_t>(k)] += turn;
    }
  }

  static void FinishStarts(const std::array<int32_t, kTileSide>& along_i, InteriorRows& rows) {
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

  void FinishRows(InteriorRows& rows) const {
    for (size_t row = 0; row < InteriorRows::kRows; ++row) {
      const uint64_t changes = rows.rows_[row];
      const bool starts_inside = IsInside(rule_, rows.starts_[row]);
      if (changes == 0 || rule_ == InteriorRule::kParity) {
        rows.rows_[row] = RunningParity(changes) ^ (starts_inside ? From(0) : 0);
      } else {
        rows.rows_[row] = SumRow(changes, rows.starts_[row], &rows.turns_[row * kTileSide]);
      }
    }
  }

  // Clears the turns that it reads.
  uint64_t SumRow(uint64_t changes, int32_t sum, int32_t* turns) const {
    uint64_t inside = IsInside(rule_, sum) ? From(0) : 0;
    for (; changes != 0; changes &= changes - 1) {
      const int k = std::countr_zero(changes);
      const bool was_inside = IsInside(rule_, sum);
      sum += turns[k];
      turns[k] = 0;
      if (IsInside(rule_, sum) != was_inside) inside ^= From(k);
    }
    return inside;
  }

  const SnappedMesh& mesh_;
  const InteriorRule rule_;
  StopSignal stop_;
  const Vec3i first_tile_;               // of the region
  const std::vector<uint64_t> corners_;  // of lines through the tiles' corners, in tiles
  std::vector<int32_t> sums_;            // up to each of them, included
};

class OpenInterior : public Interior {
 public:
  OpenInterior(const SnappedMesh& mesh, InteriorRule rule, const IndexBox& region, StopSignal stop)
      : rule_(rule), crossings_(FindLineCrossings<kSubvoxelBits>(mesh, region, stop)) {}

  bool MayHold(const Vec3i& tile_ijk, int level) const override {
    const Vec3i low = tile_ijk * kTileSide;
    for (int32_t i = low[0]; i < low[0] + (kTileSide << level); ++i) {
      if (!Crossings(i, low[1], low[1] + (kTileSide << level)).empty()) return true;
    }
    return false;
  }

  void Find(const Vec3i& tile_ijk, std::span<const uint32_t>, InteriorRows& rows) const override {
    const Vec3i low = tile_ijk * kTileSide;
    std::fill(rows.rows_.begin(), rows.rows_.end(), 0);
    for (int32_t i = 0; i < kTileSide; ++i) {
      std::span<const uint64_t> some = Crossings(low[0] + i, low[1], low[1] + kTileSide);
      while (!some.empty()) {
        const int32_t j = LineCrossing::LineJ(some.front());
        const auto end =
            std::find_if(some.begin(), some.end(), [&](uint64_t c) { return LineCrossing::LineJ(c) != j; });
        const auto line = some.first(static_cast<size_t>(end - some.begin()));
        rows.rows_[static_cast<size_t>(i * kTileSide + j - low[1])] = RowOf(line, low[2]);
        some = some.subspan(line.size());
      }
    }
  }

 private:
  // The crossings of the lines (i, j), j_begin <= j < j_end.
  std::span<const uint64_t> Crossings(int32_t i, int32_t j_begin, int32_t j_end) const {
    const auto least = [&](int32_t j) {
      return std::lower_bound(crossings_.begin(), crossings_.end(), LineCrossing::Least(i, j, -kTileSide));
    };
    return {least(j_begin), least(j_end)};
  }

  // The row of a line, k from `low` on, from all crossings of the line.
  uint64_t RowOf(std::span<const uint64_t> line, int32_t low) const {
    uint64_t inside = 0;
    int32_t sum = 0;
    for (const uint64_t crossing : line) {
      const bool was_inside = IsInside(rule_, sum);
      sum += LineCrossing::Turn(crossing);
      if (IsInside(rule_, sum) != was_inside)
        inside ^= From(std::clamp(LineCrossing::Above(crossing) - low, 0, kTileSide));
    }
    return IsUnbalanced(rule_, sum) ? 0 : inside;
  }

  const InteriorRule rule_;
  const std::vector<uint64_t> crossings_;
};

std::unique_ptr<Interior> MakeClosedInterior(const SnappedMesh& mesh, InteriorRule rule, const IndexBox& region,
                                             StopSignal stop) {
  return std::make_unique<ClosedInterior>(mesh, rule, region, stop);
}

std::unique_ptr<Interior> MakeOpenInterior(const SnappedMesh& mesh, InteriorRule rule, const IndexBox& region,
                                           StopSignal stop) {
  return std::make_unique<OpenInterior>(mesh, rule, region, stop);
}

}  // namespace latvox
