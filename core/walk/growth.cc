#include "core/walk/growth.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdlib>

#include "core/snap/snap.h"

namespace latvox {
namespace {

constexpr int32_t kMostTilesBeside = (kMostPlannedReach + kTileSide - 1) / kTileSide;
constexpr size_t kMostWords = 2 * kMostTilesBeside + 1;

// The bits of rows of consecutive tiles along k. Words behind them are 0: Widen reads as many as a step of it takes,
// which is no longer than the reach.
struct LongRow {
  std::array<uint64_t, kMostWords + kMostTilesBeside> words{};
  size_t size = 0;

  uint64_t WordAt(int32_t bit) const {
    const auto word = static_cast<size_t>(bit >> kTileBits);
    const int shift = bit & (kTileSide - 1);
    return shift == 0 ? words[word] : words[word] >> shift | words[word + 1] << (kTileSide - shift);
  }
  // Sets bit b where any of the bits b .. b + count is set. Precondition: count <= 2 * kMostPlannedReach.
  void Widen(int32_t count) {
    for (int32_t have = 1; have <= count;) {
      const int32_t more = std::min(have, count + 1 - have);
      for (size_t n = 0; n < size; ++n) words[n] |= WordAt(static_cast<int32_t>(n) * kTileSide + more);
      have += more;
    }
  }
};

}  // namespace

// Rows come in the order of |di| + |dj|.
Ball::Ball(const BandPlan& length, StopSignal stop) : reach_(length.reach) {
  static_assert(sizeof(Run) == 16);
  runs_.reserve(static_cast<size_t>(2 * reach_[0] + 1) * static_cast<size_t>(2 * reach_[1] + 1));
  assert(std::ranges::all_of(reach_, [](int32_t voxels) { return voxels <= kMostPlannedReach; }));
  for (int32_t steps = 0; steps <= reach_[0] + reach_[1] && !stop.Stopped(); ++steps) {
    const int32_t most = std::min(steps, reach_[0]);
    for (int32_t i = -most; i <= most; ++i) {
      const int32_t j = steps - std::abs(i);
      if (j > reach_[1]) continue;
      Add(RunAlong(length, i, -j));
      if (j != 0) Add(RunAlong(length, i, j));
    }
  }
}

void Ball::Add(const Run& run) {
  if (run.low <= run.high) runs_.push_back(run);
}

// The ball is convex. Doubles tell about where the run ends, and integers exactly.
Ball::Run Ball::RunAlong(const BandPlan& length, int32_t i, int32_t j) {
  const auto inner = [&](const Vec3i& u, const Vec3i& v) {
    return Inner(length.metric, u * kLatticeUnit, v * kLatticeUnit);
  };
  const Vec3i row{i, j, 0}, along{0, 0, 1};
  const auto a = static_cast<double>(inner(along, along)), b = static_cast<double>(inner(row, along));
  const double room = static_cast<double>(length.limit - inner(row, row)) + b * b / a;
  const double middle = -b / a, half = std::sqrt(std::max(room / a, 0.0)) + 1;
  Run run{i, j, static_cast<int32_t>(std::floor(middle - half)), static_cast<int32_t>(std::ceil(middle + half))};
  const auto is_in = [&](int32_t k) { return inner({i, j, k}, {i, j, k}) <= length.limit; };
  while (run.low <= run.high && !is_in(run.low)) ++run.low;
  while (run.low <= run.high && !is_in(run.high)) --run.high;
  return run;
}

// Near rows come first, because they often fill a row at once.
void Ball::Grow(const std::function<const TileRows*(const Vec3i& beside)>& set, StopSignal stop, TileRows& rows) const {
  Vec3i most;
  for (size_t m = 0; m < 3; ++m) most[m] = (reach_[m] + kTileSide - 1) >> kTileBits;
  const Vec3i side = most + most + Vec3i{1, 1, 1};
  std::vector<const TileRows*> around;
  for (int32_t i = -most[0]; i <= most[0]; ++i) {
    for (int32_t j = -most[1]; j <= most[1]; ++j) {
      for (int32_t k = -most[2]; k <= most[2]; ++k) around.push_back(set({i, j, k}));
    }
  }
  if (std::all_of(around.begin(), around.end(), [](const TileRows* one) { return one == nullptr; })) return;
  LongRow from;
  from.size = static_cast<size_t>(side[2]);
  for (int32_t row = 0; row < kTileSide * kTileSide && !stop.Stopped(); ++row) {
    uint64_t& out = rows[static_cast<size_t>(row)];
    for (const Run& run : runs_) {
      if (out == ~uint64_t{0}) break;
      const int32_t i = (row >> kTileBits) + run.di, j = (row & (kTileSide - 1)) + run.dj;
      const int32_t first = (((i >> kTileBits) + most[0]) * side[1] + (j >> kTileBits) + most[1]) * side[2];
      const auto in_tile = static_cast<size_t>((i & (kTileSide - 1)) << kTileBits | (j & (kTileSide - 1)));
      uint64_t any = 0;
      from.words = {};
      for (size_t n = 0; n < from.size; ++n) {
        const TileRows* const tile = around[static_cast<size_t>(first) + n];
        if (tile != nullptr) any |= from.words[n] = (*tile)[in_tile];
      }
      if (any == 0) continue;
      from.Widen(run.high - run.low);
      out |= from.WordAt(most[2] * kTileSide + run.low);
    }
  }
}

}  // namespace latvox
