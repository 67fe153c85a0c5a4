#include "core/snap/snap.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_format.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace latvox {
namespace {

using oneapi::tbb::blocked_range;

constexpr size_t kGrain = 4096;  // vertices or triangles a task
constexpr char kAxisName[] = "ijk";

// The unrounded lattice coordinate of p along each axis. One fixed expression: the digest depends on its rounding.
Vec3d ToLattice(const Lattice& lattice, const Vec3d& origin, const Vec3f& p) {
  const Mat3d& inverse = lattice.inverse();
  const Vec3d d{p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]};
  Vec3d v;
  for (size_t m = 0; m < 3; ++m) v[m] = (inverse[0][m] * d[0] + inverse[1][m] * d[1]) + inverse[2][m] * d[2];
  return v;
}

struct Range {
  Vec3d min, max;
};

// Only vertices that triangles use count.
Range LatticeRange(const TriangleMesh& mesh, const Lattice& lattice, const Vec3d& origin) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Range empty{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  const auto join = [](Range a, const Range& b) {
    for (size_t m = 0; m < 3; ++m) {
      a.min[m] = std::min(a.min[m], b.min[m]);
      a.max[m] = std::max(a.max[m], b.max[m]);
    }
    return a;
  };
  return oneapi::tbb::parallel_reduce(
      blocked_range<size_t>(0, mesh.triangles.size(), kGrain), empty,
      [&](const blocked_range<size_t>& part, Range range) {
        for (size_t t = part.begin(); t < part.end(); ++t) {
          for (uint32_t index : mesh.triangles[t]) {
            const Vec3d v = ToLattice(lattice, origin, mesh.vertices[index]);
            range = join(range, {v, v});
          }
        }
        return range;
      },
      join);
}

// A symmetric hash of the edge between two points.
std::pair<uint64_t, uint64_t> EdgeHash(Vec3i a, Vec3i b) {
  if (b < a) std::swap(a, b);
  const std::array<Vec3i, 2> edge{a, b};
  const XXH128_hash_t hash = XXH3_128bits(edge.data(), sizeof(edge));
  return {hash.low64, hash.high64};
}

struct FactsSum {
  uint64_t degenerate = 0, low = 0, high = 0;
};

}  // namespace

absl::StatusOr<SnappedMesh> Snap(TriangleMesh mesh, const Lattice& lattice, const Vec3d& origin, const Vec3i& reach) {
  const Range range = LatticeRange(mesh, lattice, origin);
  constexpr double kMaxPosition = 1 << kPositionBits;
  SnappedMesh snapped;
  for (size_t m = 0; m < 3; ++m) {
    for (double x : {range.min[m], range.max[m]}) {
      if (!(std::abs(x) <= kMaxPosition)) {
        return absl::InvalidArgumentError(
            absl::StrFormat("origin: it puts the mesh at lattice coordinate %g on axis %c, the limit is %.0f", x,
                            kAxisName[m], kMaxPosition));
      }
    }
    const double extent = std::floor(range.max[m]) - std::floor(range.min[m]) + 1;
    if (extent > kMaxExtent) {
      return absl::InvalidArgumentError(
          absl::StrFormat("voxel_size: the mesh extends over %.0f voxels on lattice axis %c, the limit is %d", extent,
                          kAxisName[m], kMaxExtent));
    }
    // One unit below, since rounding may move the lowest vertex that far; a tile's multiple, for bricks and parity.
    const auto low = static_cast<int32_t>(std::floor(range.min[m] - 1.0 / kLatticeUnit));
    snapped.base_ijk[m] = low & ~(kTileSide - 1);
  }

  snapped.vertices_lat.resize(mesh.vertices.size());
  oneapi::tbb::parallel_for(blocked_range<size_t>(0, mesh.vertices.size(), kGrain), [&](const auto& part) {
    for (size_t n = part.begin(); n < part.end(); ++n) {
      const Vec3d v = ToLattice(lattice, origin, mesh.vertices[n]);
      for (size_t m = 0; m < 3; ++m) {
        // Vertices that no triangle uses may lie anywhere; they are never read.
        const double clamped = std::clamp(v[m], range.min[m], range.max[m]);
        const double units = std::nearbyint(clamped * kLatticeUnit);
        snapped.vertices_lat[n][m] =
            static_cast<int32_t>(static_cast<int64_t>(units) - int64_t{snapped.base_ijk[m]} * kLatticeUnit);
      }
    }
  });
  snapped.triangles = std::move(mesh.triangles);

  for (size_t m = 0; m < 3; ++m) {
    // The nearer end of a crossed edge lies within reach/2 of the surface.
    const double half = reach[m] / 2.0;
    const auto unit = [](double x) { return std::nearbyint(x * kLatticeUnit) / kLatticeUnit; };
    snapped.box.min[m] = static_cast<int32_t>(std::ceil(unit(range.min[m]) - half)) - snapped.base_ijk[m];
    snapped.box.max[m] = static_cast<int32_t>(std::floor(unit(range.max[m]) + half)) - snapped.base_ijk[m] + 1;
  }
  return snapped;
}

SurfaceFacts FactsOf(const SnappedMesh& mesh) {
  const FactsSum sum = oneapi::tbb::parallel_reduce(
      blocked_range<size_t>(0, mesh.triangles.size(), kGrain), FactsSum{},
      [&](const blocked_range<size_t>& part, FactsSum s) {
        for (size_t t = part.begin(); t < part.end(); ++t) {
          std::array<Vec<int64_t, 3>, 3> wide;
          for (size_t n = 0; n < 3; ++n) {
            const Vec3i& a = mesh.vertices_lat[mesh.triangles[t][n]];
            const Vec3i& b = mesh.vertices_lat[mesh.triangles[t][(n + 1) % 3]];
            wide[n] = {a[0], a[1], a[2]};
            if (a == b) continue;
            const auto [low, high] = EdgeHash(a, b);
            s.low ^= low;
            s.high ^= high;
          }
          s.degenerate += Cross(wide[1] - wide[0], wide[2] - wide[0]) == Vec<int64_t, 3>{};
        }
        return s;
      },
      [](const FactsSum& a, const FactsSum& b) {
        return FactsSum{a.degenerate + b.degenerate, a.low ^ b.low, a.high ^ b.high};
      });
  return {sum.degenerate, sum.low == 0 && sum.high == 0};
}

}  // namespace latvox
