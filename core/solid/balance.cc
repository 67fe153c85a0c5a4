#include "core/solid/balance.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <vector>

#include "core/solid/axis_crossing.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace latvox {
namespace {

using Part = oneapi::tbb::blocked_range<size_t>;

// A linear form of the edges' multiplicities, modulo 2^64 in each half.
using EdgeSum = std::array<uint64_t, 2>;

void AddEdge(const Vec3i& from, const Vec3i& to, EdgeSum& sum) {
  if (from == to) return;
  const bool up = from < to;
  const std::array<Vec3i, 2> ends = {up ? from : to, up ? to : from};
  const XXH128_hash_t hash = XXH3_128bits(ends.data(), sizeof(ends));
  sum[0] += up ? hash.low64 : 0 - hash.low64;
  sum[1] += up ? hash.high64 : 0 - hash.high64;
}

// A square of lines along k: a, b are i, j of its lowest line.
struct Square {
  int32_t a, b;
  int level;  // its side is 64 << level lines
  AxisLines Lines() const {
    const int64_t last = (int64_t{kTileSide} << level) - 1;
    return {{a, a + last}, {b, b + last}};
  }
};

class LineCount {
 public:
  LineCount(const SnappedMesh& mesh, InteriorRule rule, StopSignal stop) : mesh_(mesh), rule_(rule), stop_(stop) {}

  uint64_t Unbalanced(const Square& square, const std::vector<uint32_t>& triangles) const {
    if (triangles.empty() || stop_.Stopped()) return 0;
    if (square.level == 0) return CountLines(square, triangles);
    return oneapi::tbb::parallel_reduce(
        oneapi::tbb::blocked_range<int32_t>(0, 4), uint64_t{0},
        [&](const auto& quarters, uint64_t sum) {
          for (int32_t n = quarters.begin(); n < quarters.end(); ++n) {
            const int32_t side = kTileSide << (square.level - 1);
            const Square quarter{square.a + (n >> 1) * side, square.b + (n & 1) * side, square.level - 1};
            sum += Unbalanced(quarter, Near(quarter, triangles));
          }
          return sum;
        },
        std::plus<>());
  }

 private:
  std::vector<uint32_t> Near(const Square& square, const std::vector<uint32_t>& triangles) const {
    const AxisLines lines = square.Lines();
    std::vector<uint32_t> near;
    std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(near), [&](uint32_t t) {
      const Triangle v = mesh_.TriangleAt(t);
      const auto meets = [&](size_t m, const crossing_internal::Span& span) {
        const auto [low, high] = std::minmax({v[0][m], v[1][m], v[2][m]});
        return low <= span.last * kLatticeUnit && high >= span.first * kLatticeUnit;
      };
      return !stop_.Stopped() && meets(0, lines.a) && meets(1, lines.b);
    });
    return near;
  }

  uint64_t CountLines(const Square& square, const std::vector<uint32_t>& triangles) const {
    std::array<int32_t, size_t{kTileSide} * kTileSide> sums{};
    for (const uint32_t t : triangles) {
      if (stop_.Stopped()) return 0;
      ForEachAxisCrossing<kSubvoxelBits>(mesh_.TriangleAt(t), 2, square.Lines(),
                                         [&](int32_t a, int32_t b, int32_t, int32_t turn) {
                                           sums[static_cast<size_t>((a - square.a) * kTileSide + b - square.b)] += turn;
                                         });
    }
    return static_cast<uint64_t>(
        std::count_if(sums.begin(), sums.end(), [&](int32_t sum) { return IsUnbalanced(rule_, sum); }));
  }

  const SnappedMesh& mesh_;
  const InteriorRule rule_;
  StopSignal stop_;
};

}  // namespace

bool IsOriented(const SnappedMesh& mesh, StopSignal stop) {
  constexpr size_t kGrain = 4096;  // triangles for each task
  const EdgeSum sum = oneapi::tbb::parallel_reduce(
      Part(0, mesh.triangles.size(), kGrain), EdgeSum{},
      [&](const Part& part, EdgeSum so_far) {
        for (size_t t = part.begin(); t < part.end() && !stop.Stopped(); ++t) {
          const auto [a, b, c] = mesh.TriangleAt(t);
          AddEdge(a, b, so_far);
          AddEdge(b, c, so_far);
          AddEdge(c, a, so_far);
        }
        return so_far;
      },
      [](const EdgeSum& x, const EdgeSum& y) {
        return EdgeSum{x[0] + y[0], x[1] + y[1]};
      });
  return sum == EdgeSum{};
}

uint64_t CountUnbalancedLines(const SnappedMesh& mesh, InteriorRule rule, StopSignal stop) {
  std::vector<uint32_t> triangles(mesh.triangles.size());
  std::iota(triangles.begin(), triangles.end(), 0);
  // Vertices lie above 0; the box reaches beyond them.
  int level = 0;
  while ((kTileSide << level) < std::max(mesh.box.max[0], mesh.box.max[1])) ++level;
  return LineCount(mesh, rule, stop).Unbalanced({0, 0, level}, triangles);
}

}  // namespace latvox
