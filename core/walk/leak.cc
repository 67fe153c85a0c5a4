#include "core/walk/leak.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/band/metric.h"
#include "core/band/triangle_distance.h"

namespace latvox {
namespace {

constexpr uint8_t kUnknown = 255, kMostClearance = 254;
constexpr uint32_t kOutside = std::numeric_limits<uint32_t>::max();

// Numbers the points of a box, and finds the way.
class WaySearch {
 public:
  WaySearch(const std::vector<Frame>& frames, const IndexBox& box, std::vector<uint8_t>& clearance, StopSignal stop)
      : box_(box), side_(box.max - box.min), clearance_(clearance), stop_(stop) {
    for (const Frame& frame : frames) {
      steps_.push_back(frame.q);
      steps_.push_back(-frame.q);
    }
    std::sort(steps_.begin(), steps_.end());
  }

  void FindClearances();
  std::vector<uint32_t> Climb(uint32_t from) const;
  // The least clearance of the widest ways from a point.
  uint8_t WidthFrom(uint32_t from);
  // A way from a point over points with at least this clearance, as few as possible with no more; without the last
  // point outside.
  std::vector<uint32_t> WidestFrom(uint32_t from, uint8_t width, Vec3i& outside);

  uint32_t NumberOf(const Vec3i& ijk) const {
    const Vec3i at = ijk - box_.min;
    for (size_t m = 0; m < 3; ++m) {
      if (at[m] < 0 || at[m] >= side_[m]) return kOutside;
    }
    return static_cast<uint32_t>((int64_t{at[0]} * side_[1] + at[1]) * side_[2] + at[2]);
  }
  Vec3i PointAt(uint32_t number) const {
    const auto n = static_cast<int64_t>(number), row = n / side_[2];
    return box_.min + Vec3i{static_cast<int32_t>(row / side_[1]), static_cast<int32_t>(row % side_[1]),
                            static_cast<int32_t>(n % side_[2])};
  }

 private:
  std::vector<uint32_t> WayTo(uint32_t last, uint32_t first) const;
  // Looks at the signal now and then.
  bool IsStopped() { return ++polls_ % 4096 == 0 && stop_.Stopped(); }

  const IndexBox box_;
  const Vec3i side_;
  std::vector<uint8_t>& clearance_;
  StopSignal stop_;
  size_t polls_ = 0;
  std::vector<Vec3i> steps_;
  std::vector<uint8_t> from_;  // by point: 0, or 1 + the number of the step that led there
};

// Breadth first from all walls at once. Walls may be most of the points, so they are not listed.
void WaySearch::FindClearances() {
  std::vector<uint32_t> shell, next;
  const auto look_around = [&](uint32_t n, uint8_t steps) {
    const Vec3i at = PointAt(n);
    for (const Vec3i& q : steps_) {
      const uint32_t other = NumberOf(at + q);
      if (other == kOutside || clearance_[other] != kUnknown) continue;
      clearance_[other] = steps;
      next.push_back(other);
    }
  };
  std::ranges::replace_if(
      clearance_, [](uint8_t clearance) { return clearance != 0; }, kUnknown);
  for (uint32_t n = 0; n < clearance_.size(); ++n) {
    if (IsStopped()) return;
    if (clearance_[n] == 0) look_around(n, 1);
  }
  for (uint8_t steps = 2; !next.empty() && !stop_.Stopped(); steps = std::min<uint8_t>(steps + 1, kMostClearance)) {
    shell.swap(next);
    next.clear();
    for (const uint32_t n : shell) {
      if (IsStopped()) return;
      look_around(n, steps);
    }
  }
}

// The points of the climb, without the last.
std::vector<uint32_t> WaySearch::Climb(uint32_t from) const {
  std::vector<uint32_t> climb{from};
  for (;;) {
    const uint32_t at = climb.back();
    uint32_t best = at;
    for (const Vec3i& q : steps_) {
      const uint32_t other = NumberOf(PointAt(at) + q);
      if (other != kOutside && clearance_[other] > clearance_[best]) best = other;
    }
    if (best == at) return climb;
    climb.push_back(best);
  }
}

// Shell by shell, so that few points wait at a time.
uint8_t WaySearch::WidthFrom(uint32_t from) {
  std::array<std::vector<uint32_t>, 256> todo;
  std::vector<uint32_t> shell;
  from_.assign(clearance_.size(), 0);
  uint8_t width = clearance_[from];
  todo[width].push_back(from);
  from_[from] = 1;
  while (width > 0) {
    if (todo[width].empty()) {
      --width;
      continue;
    }
    shell.clear();
    shell.swap(todo[width]);
    for (const uint32_t n : shell) {
      if (IsStopped()) return 0;
      const Vec3i at = PointAt(n);
      for (const Vec3i& q : steps_) {
        const uint32_t other = NumberOf(at + q);
        if (other == kOutside) return width;
        if (clearance_[other] == 0 || from_[other] != 0) continue;
        from_[other] = 1;
        todo[std::min(width, clearance_[other])].push_back(other);
      }
    }
  }
  return 0;
}

// Breadth first, in turns: narrow points wait until no others are left.
std::vector<uint32_t> WaySearch::WidestFrom(uint32_t from, uint8_t width, Vec3i& outside) {
  from_.assign(clearance_.size(), 0);
  from_[from] = kUnknown;
  std::vector<uint32_t> turn{from}, next_turn, shell;
  while (!turn.empty()) {
    shell = std::exchange(turn, {});
    for (const uint32_t n : shell) {
      if (IsStopped()) return {};
      const Vec3i at = PointAt(n);
      for (size_t step = 0; step < steps_.size(); ++step) {
        const uint32_t other = NumberOf(at + steps_[step]);
        if (other == kOutside) {
          outside = at + steps_[step];
          return WayTo(n, from);
        }
        if (clearance_[other] < width || from_[other] != 0) continue;
        from_[other] = static_cast<uint8_t>(step + 1);
        (clearance_[other] == width ? next_turn : turn).push_back(other);
      }
    }
    if (turn.empty()) turn = std::exchange(next_turn, {});
  }
  return {};
}

std::vector<uint32_t> WaySearch::WayTo(uint32_t last, uint32_t first) const {
  std::vector<uint32_t> way{last};
  while (way.back() != first) {
    const uint32_t at = way.back();
    way.push_back(NumberOf(PointAt(at) - steps_[from_[at] - size_t{1}]));
  }
  std::reverse(way.begin(), way.end());
  return way;
}

}  // namespace

std::vector<Vec3i> FindWayOut(const std::vector<Frame>& frames, const IndexBox& box, std::vector<uint8_t>& clearance,
                              const Vec3i& start, StopSignal stop, Vec3i& narrowest) {
  WaySearch search(frames, box, clearance, stop);
  search.FindClearances();
  if (stop.Stopped()) return {};
  std::vector<uint32_t> way = search.Climb(search.NumberOf(start));
  const uint32_t top = way.back();
  way.pop_back();
  const uint8_t width = search.WidthFrom(top);
  Vec3i outside{};
  const std::vector<uint32_t> rest = width == 0 ? std::vector<uint32_t>{} : search.WidestFrom(top, width, outside);
  if (rest.empty()) return {};
  const auto is_narrowest = [&](uint32_t n) { return clearance[n] == width; };
  const auto first = std::find_if(rest.begin(), rest.end(), is_narrowest);
  const auto end = std::find_if_not(first, rest.end(), is_narrowest);
  narrowest = search.PointAt(*(first + (end - first) / 2));
  way.insert(way.end(), rest.begin(), rest.end());
  std::vector<Vec3i> path;
  path.reserve(way.size() + 1);
  for (const uint32_t n : way) path.push_back(search.PointAt(n));
  path.push_back(outside);
  return path;
}

double DistanceFromMesh(const SnappedMesh& mesh, const Lattice& lattice, const Vec3i& point, StopSignal stop) {
  const absl::StatusOr<Metric> metric = MakeMetric(lattice);
  if (!metric.ok()) return -1;
  double least = std::numeric_limits<double>::infinity();
  for (size_t t = 0; t < mesh.triangles.size() && !stop.Stopped(); ++t) {
    least = std::min(least, TriangleDistance(*metric, mesh.TriangleAt(t)).SquareTo(point * kLatticeUnit));
  }
  return std::sqrt(least) * lattice.voxel_size() / kLatticeUnit;
}

}  // namespace latvox
