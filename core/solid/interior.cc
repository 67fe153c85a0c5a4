#include "core/solid/interior.h"

#include <algorithm>

#include "core/solid/closed_rows.h"
#include "core/solid/line_crossings.h"
#include "core/solid/tile_crossings.h"

namespace latvox {
namespace {

// The points `first` .. 63 of a row.
constexpr uint64_t From(int32_t first) { return first >= kTileSide ? 0 : ~uint64_t{0} << first; }

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
    for (const uint64_t corner : corners_) {
      if (stop.Stopped()) {
        corners_.clear();  // each of them has a sum
        return;
      }
      sums_.push_back(sum += LineCrossing::Turn(corner));
    }
  }

  // It is the same for the whole cube, so a tile that meets the region decides.
  bool MayHold(const Vec3i& tile_ijk, int) const override {
    Vec3i tile;
    for (size_t m = 0; m < 3; ++m) tile[m] = std::max(tile_ijk[m], first_tile_[m]);
    return IsInside(rule_, SumAtCorner(tile));
  }

  void Find(const Vec3i& tile_ijk, std::span<const uint32_t> triangles, InteriorRows& rows) const override {
    ClosedRows::Find(mesh_, rule_, tile_ijk * kTileSide, SumAtCorner(tile_ijk), triangles, stop_, rows);
  }

 private:
  int32_t SumAtCorner(const Vec3i& tile_ijk) const {
    const uint64_t end = LineCrossing::Least(tile_ijk[0], tile_ijk[1], tile_ijk[2] + 1);
    const auto after = std::lower_bound(corners_.begin(), corners_.end(), end);
    return after == corners_.begin() ? 0 : sums_[static_cast<size_t>(after - corners_.begin()) - 1];
  }

  const SnappedMesh& mesh_;
  const InteriorRule rule_;
  StopSignal stop_;
  const Vec3i first_tile_;           // of the region
  LineCrossings<uint64_t> corners_;  // of lines through the tiles' corners, in tiles
  std::vector<int32_t> sums_;        // up to each of them, included
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
  const LineCrossings<uint64_t> crossings_;
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
