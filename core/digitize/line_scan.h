// A triangle's scan along its principal direction, reduced to integers that are linear over the lattice lines.
//
// In the frame of C (core/lattice/frame.h), with U = kLatticeUnit, the triangle's edge A -> B turns into
//   E(a, b) = dx * (b*U - y) - dy * (a*U - x) + tie - 1        line (a, b) is on the inner side iff E >= 0
// and the voxel of line (a, b) nearest to the triangle's plane, with ties as in core/digitize/crossing.h, into
//   N(a, b) = (z0 + U/2) * along - n_a * (a*U - x0) - n_b * (b*U - y0) - flip
//   depth   = floor(N / (along*U)),   and the plane lies above the voxel iff the remainder is at least along*U/2.
// Both step by multiples of U. So with E' = floor(E/U), M = floor(N/U) and s = N mod U, which is the same on all lines,
//   E >= 0 <=> E' >= 0,   depth = floor(M / along),   above <=> (M mod along) * U + s >= along * U / 2
//     <=> M mod along >= half,   half = along/2 if along is even, else (along + 1)/2, or 1 less if s >= U/2:
// eight bits less, so that triangles up to some 60 voxels fit lanes of 32 bits.
#ifndef LATVOX_CORE_DIGITIZE_LINE_SCAN_H_
#define LATVOX_CORE_DIGITIZE_LINE_SCAN_H_

#include <algorithm>
#include <array>
#include <cstdint>
#include <type_traits>

#include "core/digitize/principal_scan.h"

namespace latvox {

// T is the type of lanes: int32_t for triangles with an extent up to NarrowExtent(frames), or int64_t.
// The lines are a .. a + width - 1 and b .. b + height - 1; `edge`, `depth` and `remainder` are those of (a, b), and
// what ends in _a or _b is the step to the next a or b.
template <class T>
struct LineScan {
  int64_t a, b;
  int32_t width, height;
  std::array<T, 3> edge, edge_a, edge_b;  // E'
  std::array<T, 3> rim;                   // candidates have E' >= -rim
  T along, level_a, level_b;              // along, and the steps of M
  T remainder, half;
  int32_t depth;
  // For whoever goes through the lines in blocks: log2 of a block's height, and what one block to the right and one
  // down add to the depth of a line.
  int32_t shape, right_depth, down_depth;
  T right_remainder, down_remainder;
};

// The largest extent of a triangle, per axis in lattice units, that LineScan<int32_t> can hold: with at most 14 bits,
// projected differences have 16, E' 26 and normals 28; and what is a product of a normal and a column of U, which
// `along` is, has at most 30.
int32_t NarrowExtent(const std::vector<ScanFrame>& frames);

// What lanes look up: entry n of a row belongs to frame n.
struct FrameTable {
  struct alignas(64) Row {
    int32_t of[kMaxDirections];
  };
  size_t size, hull_size = 0;
  int32_t reach = 0;  // largest |entry| of the directions
  std::array<Row, 3> q{};
  std::array<std::array<Row, 3>, 3> r{};
  std::array<std::array<Row, 3>, 2> u{};
  std::array<Row, 2> rim{};            // lattice units by which candidates' lines may lie beside the triangle: for a, b
  std::array<Row, 2> first{}, last{};  // lines that meet the box: a, b
  std::array<std::array<Row, 2>, kMaxHull> hull{};

  // box: as for MakeLineScan.
  FrameTable(const std::vector<ScanFrame>& frames, const IndexBox& box);
};

// Returns false if the triangle has no candidate in `box` (local voxels).
// Precondition: `scan` is the frame of the triangle's principal direction; triangle.normal is not 0.
template <class T>
bool MakeLineScan(const OrientedTriangle& triangle, const ScanFrame& scan, const IndexBox& box, LineScan<T>& out) {
  using Wide = std::conditional_t<sizeof(T) == 4, int64_t, __int128>;
  using crossing_internal::ProjectedEdge;
  constexpr int64_t kHalf = kLatticeUnit / 2;
  const Frame& frame = scan.frame;
  const int64_t up = Dot(triangle.normal, frame.q);
  // Counter-clockwise in the projection: the normal must point along q.
  const bool flip = up < 0;
  const int64_t along = flip ? -up : up;
  const std::array<const Vec<int64_t, 3>*, 3> v{&triangle.v[0], &triangle.v[flip ? 2 : 1], &triangle.v[flip ? 1 : 2]};
  std::array<int64_t, 3> x, y;
  for (size_t n = 0; n < 3; ++n) {
    x[n] = Dot(frame.r[0], *v[n]);
    y[n] = Dot(frame.r[1], *v[n]);
  }
  const auto lines = [](const std::array<int64_t, 3>& p, int64_t reach, const crossing_internal::Span& within) {
    const int64_t low = std::min({p[0], p[1], p[2]}), high = std::max({p[0], p[1], p[2]});
    return crossing_internal::Span{std::max((low - reach * kHalf + kLatticeUnit - 1) >> kSubvoxelBits, within.first),
                                   std::min((high + reach * kHalf) >> kSubvoxelBits, within.last)};
  };
  const auto a = lines(x, scan.reach_a, crossing_internal::RangeOver(box, frame.r[0]));
  const auto b = lines(y, scan.reach_b, crossing_internal::RangeOver(box, frame.r[1]));
  if (a.first > a.last || b.first > b.last) return false;
  out.a = a.first;
  out.b = b.first;
  out.width = static_cast<int32_t>(a.last - a.first + 1);
  out.height = static_cast<int32_t>(b.last - b.first + 1);

  const int64_t from_a = a.first * kLatticeUnit, from_b = b.first * kLatticeUnit;
  for (size_t n = 0; n < 3; ++n) {
    const size_t next = (n + 1) % 3;
    const ProjectedEdge edge(frame, x[n], y[n], x[next], y[next]);
    int64_t rim = 0;
    for (const auto& q : scan.hull) rim = std::max(rim, std::abs(edge.dx * q[1] - edge.dy * q[0]));
    const int64_t value = edge.dx * (from_b - edge.y) - edge.dy * (from_a - edge.x) + edge.tie - 1;
    out.edge[n] = static_cast<T>(value >> kSubvoxelBits);
    out.edge_a[n] = static_cast<T>(-edge.dy);
    out.edge_b[n] = static_cast<T>(edge.dx);
    out.rim[n] = static_cast<T>((rim + 1) / 2);
  }

  const int64_t sign = flip ? -1 : 1;
  const int64_t n_a = sign * Dot(triangle.normal, frame.u[0]), n_b = sign * Dot(triangle.normal, frame.u[1]);
  const int64_t z0 = Dot(frame.r[2], *v[0]);
  const Wide numerator =
      Wide{z0 + kHalf} * along - Wide{n_a} * (from_a - x[0]) - Wide{n_b} * (from_b - y[0]) - (flip ? 1 : 0);
  const Wide level = numerator >> kSubvoxelBits;
  const bool low_part = (static_cast<uint64_t>(numerator) & (kLatticeUnit - 1)) < kHalf;
  const Wide depth = level / along - (level % along < 0 ? 1 : 0);
  out.along = static_cast<T>(along);
  out.level_a = static_cast<T>(-n_a);
  out.level_b = static_cast<T>(-n_b);
  out.depth = static_cast<int32_t>(depth);
  out.remainder = static_cast<T>(level - depth * along);
  out.half = static_cast<T>((along + (low_part ? 1 : 0)) / 2);
  return true;
}

}  // namespace latvox

#endif  // LATVOX_CORE_DIGITIZE_LINE_SCAN_H_
