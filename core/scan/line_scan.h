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
//
// Larger triangles fit, too, as far as the lines of one box are concerned (Narrow). If all of these lines are on the
// inner side of an edge, a constant replaces it. E' of another edge comes as close to 0 as its rim somewhere among the
// lines. So it is at most the sum of the rim and the steps, which nearly always fits. Only the remainder of M counts,
// so M and `along` may be scaled to along = 2^kScaledBits, and rounded. Then remainders are wrong by less than one for
// each step from the first line. Depths and ends are right wherever the remainder is not that close to a multiple of
// along/2. Few lines are that close, except on planes that few integers describe, such as those of a box's sides. There
// M, its steps and `along` are divided by their common divisor, exactly. Triangles that still do not fit take lanes of
// 64 bits.
#ifndef LATVOX_CORE_SCAN_LINE_SCAN_H_
#define LATVOX_CORE_SCAN_LINE_SCAN_H_

#include <array>
#include <cstdint>

#include "core/digitize/principal_scan.h"
#include "core/lattice/integer_cell.h"

namespace latvox {

// T is the type of lanes. int32_t is for triangles with an extent up to NarrowExtent(frames), and for results of
// Narrow; int64_t is for others. The lines are a .. a + width - 1 and b .. b + height - 1. `edge`, `depth` and
// `remainder` belong to (a, b). Members that end in _a or _b are the steps to the next a or b.
template <class T>
struct LineScan {
  int64_t a, b;
  int32_t width, height;
  std::array<T, 3> edge, edge_a, edge_b;  // E'
  std::array<T, 3> rim;                   // candidates have E' + rim >= 0, a sum that fits T on all lines
  T along, level_a, level_b;              // along, and the steps of M
  T remainder, half;
  T doubt;  // remainders are wrong by less than this; 0: they are exact
  int32_t depth;
  // For scans by blocks of lines: log2 of a block's height, and the change of a line's depth from one block to the next
  // on the right, and below.
  int32_t shape, right_depth, down_depth;
  T right_remainder, down_remainder;
};

// The largest extent of a triangle, per axis in lattice units, that LineScan<int32_t> can hold without Narrow. With at
// most 14 bits, projected differences have 16 bits, E' 26 and normals 28. A product of a normal and a column of U, such
// as `along`, has at most 30.
int32_t NarrowExtent(const std::vector<ScanFrame>& frames);

// A box, per axis in lattice units, that contains the points of triangles on links with nearer ends in a box of voxels.
// A triangle that reaches beyond it has candidates only within it.
struct NearBox {
  Vec3i min, max;
  NearBox(const std::vector<ScanFrame>& frames, const IndexBox& box);
  // Does the same for voxels that lie up to `reach` lattice units from the point that they have of a triangle.
  NearBox(const Vec3i& reach, const IndexBox& box);
};

// Returns false if the triangle has no candidate in `box` (local voxels), whose NearBox is `near`.
// Precondition: `scan` is the frame of the triangle's principal direction; triangle.normal is not 0.
bool MakeLineScan(const OrientedTriangle& triangle, const ScanFrame& scan, const IndexBox& box, const NearBox& near,
                  LineScan<int64_t>& out);

// The lines that may have candidates in a box of the given size.
class LinesInBox {
 public:
  LinesInBox(const LineScan<int64_t>& lines, const Frame& frame, const Vec3i& size);

  // Bit m: some lines may have their voxel outside of 0 .. size - 1 on axis m.
  uint32_t astride() const { return astride_; }

  // For rows b .. b + high - 1, counted from the first: the first and the last line that may have a candidate, also
  // counted from the first. There is no such line if the last comes before the first.
  crossing_internal::Span Row(int32_t b, int32_t high) const;

 private:
  // No candidate is where at + a * per_a + b * per_b < 0.
  struct Bound {
    double at, a_per, per_b;  // a_per = -1 / per_a; 0 if that is 0
  };
  void Add(double at, double per_a, double per_b);

  std::array<Bound, 9> bounds_;  // by edges, and by sides of the box
  size_t count_ = 0;
  uint32_t astride_ = 0;
  double last_;
};

// So that steps may be up to four times `along`.
inline constexpr int kScaledBits = 29;

// Returns the same lines in 32 bits; false: they do not fit.
//   rounded   true: with rounded remainders, and only where `along` is too large for exact ones
//             false: with exact ones, divided by their common divisor
bool Narrow(const LineScan<int64_t>& lines, bool rounded, LineScan<int32_t>& out);

// Tables for lanes: entry n of a row belongs to frame n.
struct FrameTable {
  struct alignas(64) Row {
    int32_t of[kMaxDirections];
  };
  size_t size, hull_size = 0;
  int32_t reach = 0;  // largest |entry| of the directions
  std::array<Row, 3> q{};
  std::array<std::array<Row, 3>, 3> r{};
  std::array<std::array<Row, 3>, 2> u{};
  std::array<Row, 2> rim{};                         // lattice units beside the triangle where lines may be: for a, b
  std::array<Row, 2> first{}, last{};               // lines that meet the box: a, b
  std::array<std::array<Row, 2>, kMaxHull> hull{};  // for a supercover, the projections of the cell's steps
  NearBox near;
  CellSegments cell{};  // of a supercover

  // box: as for MakeLineScan.
  FrameTable(const std::vector<ScanFrame>& frames, const IndexBox& box);
  // For the scan of a supercover (core/scan/candidates.h).
  FrameTable(const std::vector<ScanFrame>& frames, const IndexBox& box, CellSegments segments);

 private:
  FrameTable(const std::vector<ScanFrame>& frames, const IndexBox& box, const NearBox& near_box);
};

}  // namespace latvox

#endif  // LATVOX_CORE_SCAN_LINE_SCAN_H_
