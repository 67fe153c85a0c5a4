// The supercover of one triangle: all lattice points whose closed Voronoi cell meets it.
//
// The cell of c meets the triangle T iff c lies in the Minkowski sum of T and the cell of 0, which is centrally
// symmetric. The sum is a convex polytope. Each of its facets is the sum of a face of the cell and a face of T. There
// are three kinds: a facet of the cell and a corner of T; a zone (edge direction) of the cell and an edge of T; a face
// of the cell and T itself. So
//   c is in iff normal . c <= room for each of these normals,
// which are the separating axes of T and the cell. Along a row of lattice points, the answer is one interval. Touching
// counts: cells and triangles are closed. Unlike in core/digitize/crossing.h, no shift is needed, because there are no
// ties. So the result depends on the set of points of the surface alone.
//
// In integers (core/lattice/integer_cell.h: lengths p <= 2^b, covectors e with absolute sum <= 2^3; corners v in
// lattice units from a voxel near T, below 2^D), for c in voxels, U = kLatticeUnit:
//   facet w           normal G w,                     room floor((max normal . v + U/2 sum p |e . w|) / U)
//   edge d, zone e    normal G a, a = (G d) x e,      room floor((normal . v(d) + U/2 sum p |e . a|) / U)
//   T                 normal n = d x d', either sign, room floor((n . v + U max over the cell of n . x) / U)
// G a = sum p_u e_u (e_u . a), and e_u . a = sum p_s (e_s . d) det(e_u, e_s, e) with determinants 0 or +-1, hence
//   e . d  D+3 bits     e . a  b+D+6     normal  2b+D+12     normal . v  2b+2D+13     room * U  2b+2D+17
// n . v  3D+4, and normals times voxels are smaller. They fit int64 for most triangles, and __int128 for all.
#ifndef LATVOX_CORE_SUPERCOVER_SUPERCOVER_H_
#define LATVOX_CORE_SUPERCOVER_SUPERCOVER_H_

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "absl/functional/function_ref.h"
#include "core/brick/brick.h"
#include "core/digitize/crossing.h"
#include "core/digitize/principal_scan.h"
#include "core/lattice/integer_cell.h"
#include "core/supercover/near_cells.h"
#include "core/supercover/short_cover.h"

namespace latvox {

class Supercover {
 public:
  explicit Supercover(const IntegerCell& cell);

  // The distance per axis, in voxels, within which a voxel lies from the parts that its cell meets; and twice that.
  // Both are rounded up.
  Vec3i Margin() const;
  Vec3i Reach() const;
  // The same as Margin(), but no less than a step of near_cells().
  Vec3i ScanReach() const;

  // Calls run(first, count) for each row of voxels of the triangle's supercover within `box` (local voxels): first and
  // the count - 1 voxels after it along k. It visits each row once, in lexicographic order.
  using Run = absl::FunctionRef<void(const Vec3i& first, int32_t count)>;
  void ForEachRun(const Triangle& triangle, const IndexBox& box, Run run) const;

  // Where cells are boxes along the lattice axes: those of the scan for k = 0 (core/supercover/box_cells.h). Else
  // empty.
  const std::vector<ScanFrame>& scan_frames() const { return scan_frames_; }
  // On most other lattices: the way for triangles that are not large. Else null.
  const NearCells* near_cells() const { return near_cells_ ? &*near_cells_ : nullptr; }

 private:
  struct Facet {
    Vec<int64_t, 3> normal;
    int64_t reach;  // of the cell along it, lattice units
  };
  template <class Int>
  class Polytope;

  IntegerCell cell_;
  ShortCover short_;
  std::vector<Facet> facets_;  // one of each pair
  Vec3i half_extent_lat_{};    // rounded down
  std::vector<ScanFrame> scan_frames_;
  std::optional<NearCells> near_cells_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_SUPERCOVER_SUPERCOVER_H_
