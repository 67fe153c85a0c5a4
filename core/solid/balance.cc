#include "core/solid/balance.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <span>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/metered.h"
#include "core/solid/axis_crossing.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace latvox {
namespace {

using Part = oneapi::tbb::blocked_range<size_t>;

// Linear forms of the edges' multiplicities.
struct EdgeSum {
  std::array<uint64_t, 2> turns{};   // modulo 2^64 in each half; an edge counts with its sense
  std::array<uint64_t, 2> parity{};  // modulo 2

  void Add(const Vec3i& from, const Vec3i& to) {
    if (from == to) return;
    const bool up = from < to;
    const std::array<Vec3i, 2> ends = {up ? from : to, up ? to : from};
    const XXH128_hash_t hash = XXH3_128bits(ends.data(), sizeof(ends));
    turns[0] += up ? hash.low64 : 0 - hash.low64;
    turns[1] += up ? hash.high64 : 0 - hash.high64;
    parity[0] ^= hash.low64;
    parity[1] ^= hash.high64;
  }
  void Add(const Triangle& triangle) {
    for (size_t n = 0; n < 3; ++n) Add(triangle[n], triangle[(n + 1) % 3]);
  }
  EdgeSum operator+(const EdgeSum& other) const {
    return {{turns[0] + other.turns[0], turns[1] + other.turns[1]},
            {parity[0] ^ other.parity[0], parity[1] ^ other.parity[1]}};
  }
  PartBalance Balance() const { return {parity == decltype(parity){}, turns == decltype(turns){}}; }
};

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

  uint64_t Unbalanced(const Square& square, std::span<const uint32_t> triangles) const {
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
  std::vector<uint32_t> Near(const Square& square, std::span<const uint32_t> triangles) const {
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

  uint64_t CountLines(const Square& square, std::span<const uint32_t> triangles) const {
    const CpuMeter::Scope scope(meter_);
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
  CpuMeter* const meter_ = CpuMeter::OfThread();
};

}  // namespace

std::string WithoutOrientation(bool closed, InteriorRule rule) {
  return closed ? absl::StrCat(" with one orientation, as the rule ", std::string{NameOf(rule)}, " asks") : "";
}

bool IsOriented(const SnappedMesh& mesh, StopSignal stop) {
  constexpr size_t kGrain = 4096;  // triangles for each task
  const EdgeSum sum = MeteredReduce(
      Part(0, mesh.triangles.size(), kGrain), EdgeSum{},
      [&](const Part& part, EdgeSum so_far) {
        for (size_t t = part.begin(); t < part.end() && !stop.Stopped(); ++t) so_far.Add(mesh.TriangleAt(t));
        return so_far;
      },
      std::plus<>());
  return sum.Balance().oriented;
}

uint64_t CountUnbalancedLines(const SnappedMesh& mesh, InteriorRule rule, StopSignal stop) {
  std::vector<uint32_t> triangles(mesh.triangles.size());
  std::iota(triangles.begin(), triangles.end(), 0);
  return CountUnbalancedLines(mesh, triangles, rule, stop);
}

uint64_t CountUnbalancedLines(const SnappedMesh& mesh, std::span<const uint32_t> triangles, InteriorRule rule,
                              StopSignal stop) {
  // Vertices lie above 0; the box reaches beyond them.
  int level = 0;
  while ((kTileSide << level) < std::max(mesh.box.max[0], mesh.box.max[1])) ++level;
  return LineCount(mesh, rule, stop).Unbalanced({0, 0, level}, triangles);
}

PartBalance BalanceOf(const SnappedMesh& mesh, std::span<const uint32_t> triangles, StopSignal stop) {
  EdgeSum sum;
  for (const uint32_t t : triangles) {
    if (stop.Stopped()) return {};
    sum.Add(mesh.TriangleAt(t));
  }
  return sum.Balance();
}

}  // namespace latvox
