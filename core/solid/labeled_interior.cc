#include "core/solid/labeled_interior.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <map>
#include <span>
#include <utility>

#include "core/brick/set_label_runs.h"
#include "core/solid/balance.h"
#include "core/solid/closed_rows.h"
#include "core/solid/line_crossings.h"
#include "core/solid/tile_crossings.h"

namespace latvox {
namespace {

template <int kUnitBits>
LineCrossings<LabeledCrossing> FindLabeledCrossings(const SnappedMesh& mesh, const Labels& labels,
                                                    const IndexBox& region, StopSignal stop) {
  return FindLineCrossings<kUnitBits>(mesh, region, stop, [&](size_t t, uint64_t place) {
    return LabeledCrossing{place, labels.of_triangles[t]};
  });
}

// The first crossing at or after a place.
LineCrossings<LabeledCrossing>::const_iterator FirstFrom(const LineCrossings<LabeledCrossing>& crossings,
                                                         uint64_t place) {
  return std::lower_bound(crossings.begin(), crossings.end(), LabeledCrossing{place, 0});
}

}  // namespace

LabelBalance BalanceOfLabels(const SnappedMesh& mesh, const Labels& labels, const Solid& solid, StopSignal stop) {
  const Labels::Groups groups = labels.ByRank(stop);
  const size_t count = labels.numbers.size();
  std::vector<PartBalance> balances(count);
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<size_t>(0, count), [&](const auto& ranks) {
    for (size_t n = ranks.begin(); n < ranks.end() && !stop.Stopped(); ++n) {
      balances[n] = BalanceOf(mesh, groups.Of(n), stop);
    }
  });
  const bool oriented = std::ranges::all_of(balances, &PartBalance::oriented);
  LabelBalance sum{RuleFor(solid.rule, oriented)};
  size_t first = count;
  for (size_t n = 0; n < count && !stop.Stopped(); ++n) {
    if (sum.rule == InteriorRule::kParity ? balances[n].closed : balances[n].oriented) continue;
    ++sum.open_labels;
    if (solid.force_open) sum.unbalanced_lines += CountUnbalancedLines(mesh, groups.Of(n), sum.rule, stop);
    if (labels.numbers[n] >= sum.first_open) continue;
    first = n;
    sum.first_open = labels.numbers[n];
  }
  if (first == count || solid.force_open) return sum;
  sum.first_lines = CountUnbalancedLines(mesh, groups.Of(first), sum.rule, stop);
  sum.first_closed = balances[first].closed;
  return sum;
}

class ClosedLabeledInterior : public Interior {
 public:
  ClosedLabeledInterior(const SnappedMesh& mesh, const Labels& labels, InteriorRule rule, const IndexBox& region,
                        StopSignal stop)
      : mesh_(mesh),
        labels_(labels),
        rule_(rule),
        stop_(stop),
        first_tile_(Shifted(region.min, kTileBits)),
        corners_(FindLabeledCrossings<kCornerBits>(mesh, labels, region, stop)) {
    // No label contains the end of a line, so no line affects the lines after it.
    std::vector<int32_t> sums(labels.numbers.size());
    counts_.reserve(corners_.size());
    uint32_t count = 0;
    for (const LabeledCrossing& corner : corners_) {
      if (stop.Stopped()) {
        corners_.clear();  // each of them has a count
        return;
      }
      int32_t& sum = sums[corner.rank];
      count -= IsInside(rule, sum) ? 1 : 0;
      sum += LineCrossing::Turn(corner.place);
      count += IsInside(rule, sum) ? 1 : 0;
      counts_.push_back(count);
    }
  }

  // It is the same for the whole cube, so a tile that meets the region decides.
  bool MayHold(const Vec3i& tile_ijk, int) const override {
    Vec3i tile;
    for (size_t m = 0; m < 3; ++m) tile[m] = std::max(tile_ijk[m], first_tile_[m]);
    const auto after = FirstFrom(corners_, LineCrossing::Least(tile[0], tile[1], tile[2] + 1));
    return after != corners_.begin() && counts_[static_cast<size_t>(after - corners_.begin()) - 1] > 0;
  }

  void Find(const Vec3i& tile_ijk, std::span<const uint32_t> triangles, InteriorRows& rows) const override {
    LabelSweep& sweep = rows.sweep_;
    sweep.Begin(rule_, labels_.numbers.size());
    ForEachBelow(tile_ijk, [&](uint32_t rank, int32_t turn) { sweep.AddStart(rank, turn); });
    const Vec3i low = tile_ijk * kTileSide;
    for (const uint32_t t : triangles) {
      if (sweep.Size() > kMostCrossings) return FindLabelByLabel(tile_ijk, triangles, rows);
      if (stop_.Stopped()) break;  // a caller may still look at the labels
      const uint32_t rank = labels_.of_triangles[t];
      ForEachTileCrossing(
          mesh_.TriangleAt(t), low, [&](size_t i, int32_t turn) { sweep.AddAlongI(i, rank, turn); },
          [&](size_t i, int32_t j, int32_t turn) { sweep.AddAlongJ(i, static_cast<size_t>(j), rank, turn); },
          [&](size_t row, int32_t k, int32_t turn) { sweep.AddAlongK(row, static_cast<size_t>(k), rank, turn); });
    }
    sweep.Finish(labels_.numbers, rows.rows_, rows.labels_);
  }

 private:
  // A tile keeps so many at a time: a few megabytes.
  static constexpr size_t kMostCrossings = 1 << 18;

  // Takes the same memory for any number of triangles and labels. From the highest priority down, each label gets the
  // points that are left.
  void FindLabelByLabel(const Vec3i& tile_ijk, std::span<const uint32_t> triangles, InteriorRows& rows) const {
    std::map<uint32_t, int32_t> sums = SumsAtCorner(tile_ijk);  // by rank
    std::vector<uint32_t> sorted(triangles.begin(), triangles.end());
    std::ranges::stable_sort(sorted, {}, [&](uint32_t t) { return labels_.of_triangles[t]; });
    for (const uint32_t t : sorted) sums.try_emplace(labels_.of_triangles[t], 0);
    std::vector<uint64_t> taken(InteriorRows::kRows);
    rows.of_points_.assign(InteriorRows::kRows * kTileSide, kNoLabel);
    auto first = sorted.begin();
    for (const auto& [rank, at_corner] : sums) {
      if (stop_.Stopped()) break;
      const auto end =
          std::find_if(first, sorted.end(), [&, rank = rank](uint32_t t) { return labels_.of_triangles[t] != rank; });
      ClosedRows::Find(mesh_, rule_, tile_ijk * kTileSide, at_corner, {first, end}, stop_, rows);
      first = end;
      for (size_t row = 0; row < InteriorRows::kRows; ++row) {
        for (uint64_t free = rows.rows_[row] & ~taken[row]; free != 0; free &= free - 1) {
          rows.of_points_[row * kTileSide + static_cast<size_t>(std::countr_zero(free))] = labels_.numbers[rank];
        }
        taken[row] |= rows.rows_[row];
      }
    }
    rows.rows_ = std::move(taken);
    SetLabelRuns(rows.of_points_, rows.labels_);
  }

  std::map<uint32_t, int32_t> SumsAtCorner(const Vec3i& tile_ijk) const {
    std::map<uint32_t, int32_t> sums;
    ForEachBelow(tile_ijk, [&](uint32_t rank, int32_t turn) { sums[rank] += turn; });
    std::erase_if(sums, [](const auto& of) { return of.second == 0; });
    return sums;
  }

  // Calls f(rank, turn) for each crossing of the line through the tile's lowest point, below it.
  template <class F>
  void ForEachBelow(const Vec3i& tile_ijk, const F& f) const {
    const uint64_t end = LineCrossing::Least(tile_ijk[0], tile_ijk[1], tile_ijk[2] + 1);
    for (auto corner = FirstFrom(corners_, LineCrossing::Least(tile_ijk[0], tile_ijk[1], -kTileSide));
         corner != corners_.end() && corner->place < end; ++corner) {
      f(corner->rank, LineCrossing::Turn(corner->place));
    }
  }

  const SnappedMesh& mesh_;
  const Labels& labels_;
  const InteriorRule rule_;
  StopSignal stop_;
  const Vec3i first_tile_;                  // of the region
  LineCrossings<LabeledCrossing> corners_;  // of lines through the tiles' corners, in tiles
  std::vector<uint32_t> counts_;            // of labels that contain the points above each of them
};

class OpenLabeledInterior : public Interior {
 public:
  OpenLabeledInterior(const SnappedMesh& mesh, const Labels& labels, InteriorRule rule, const IndexBox& region,
                      StopSignal stop)
      : labels_(labels), rule_(rule), crossings_(FindLabeledCrossings<kSubvoxelBits>(mesh, labels, region, stop)) {
    KeepBalanced(stop);
  }

  bool MayHold(const Vec3i& tile_ijk, int level) const override {
    const Vec3i low = tile_ijk * kTileSide;
    for (int32_t i = low[0]; i < low[0] + (kTileSide << level); ++i) {
      const auto first = FirstFrom(crossings_, LineCrossing::Least(i, low[1], -kTileSide));
      const auto end = LineCrossing::Least(i, low[1] + (kTileSide << level), -kTileSide);
      if (first != crossings_.end() && first->place < end) return true;
    }
    return false;
  }

  void Find(const Vec3i& tile_ijk, std::span<const uint32_t>, InteriorRows& rows) const override {
    LabelSweep& sweep = rows.sweep_;
    sweep.Begin(rule_, labels_.numbers.size());
    const Vec3i low = tile_ijk * kTileSide;
    rows.labels_.clear();
    for (int32_t i = 0; i < kTileSide; ++i) {
      auto crossing = FirstFrom(crossings_, LineCrossing::Least(low[0] + i, low[1], -kTileSide));
      for (int32_t j = 0; j < kTileSide; ++j) {
        const uint64_t end = LineCrossing::Least(low[0] + i, low[1] + j + 1, -kTileSide);
        for (; crossing != crossings_.end() && crossing->place < end; ++crossing) {
          const int32_t k = std::max(LineCrossing::Above(crossing->place) - low[2], 0);
          if (k >= kTileSide) continue;
          sweep.AddAlongK(0, static_cast<size_t>(k), crossing->rank, LineCrossing::Turn(crossing->place));
        }
        rows.labels_.starts.push_back(static_cast<uint32_t>(rows.labels_.runs.size()));
        rows.rows_[static_cast<size_t>(i * kTileSide + j)] = sweep.FinishLine(labels_.numbers, rows.labels_.runs);
      }
    }
    rows.labels_.starts.push_back(static_cast<uint32_t>(rows.labels_.runs.size()));
  }

 private:
  // Removes the crossings of labels from lines on which they are unbalanced.
  void KeepBalanced(StopSignal stop) {
    std::vector<int32_t> sums(labels_.numbers.size());  // 0 between lines
    std::vector<uint32_t> ranks;                        // of a line
    auto kept = crossings_.begin();
    for (auto first = crossings_.begin(); first != crossings_.end() && !stop.Stopped();) {
      auto end = first;
      for (; end != crossings_.end() && LineCrossing::AreOnOneLine(end->place, first->place); ++end) {
        sums[end->rank] += LineCrossing::Turn(end->place);
      }
      ranks.clear();
      for (; first != end; ++first) {
        const LabeledCrossing crossing = *first;
        ranks.push_back(crossing.rank);
        if (!IsUnbalanced(rule_, sums[crossing.rank])) *kept++ = crossing;
      }
      for (const uint32_t rank : ranks) sums[rank] = 0;
    }
    crossings_.erase(kept, crossings_.end());
  }

  const Labels& labels_;
  const InteriorRule rule_;
  LineCrossings<LabeledCrossing> crossings_;
};

std::unique_ptr<Interior> MakeClosedLabeledInterior(const SnappedMesh& mesh, const Labels& labels, InteriorRule rule,
                                                    const IndexBox& region, StopSignal stop) {
  return std::make_unique<ClosedLabeledInterior>(mesh, labels, rule, region, stop);
}

std::unique_ptr<Interior> MakeOpenLabeledInterior(const SnappedMesh& mesh, const Labels& labels, InteriorRule rule,
                                                  const IndexBox& region, StopSignal stop) {
  return std::make_unique<OpenLabeledInterior>(mesh, labels, rule, region, stop);
}

}  // namespace latvox
