// Triangles of up to about 50 voxels on BCC and FCC, and of another limit on other lattices whose cells need not be
// boxes.
//
// All triangles are scanned along their principal directions C, the q with the largest |n.q| among the neighbors whose
// cells meet the cell of 0. Such a q has q/2 in the cell, because cell and neighbor meet in a set with the center q/2.
// (1) A line that meets the triangle crosses it within C/2 of its nearest voxel z. So z is in the supercover.
// (2) If the cell of c meets the triangle, the line of c passes the triangle within the cell's projection along C.
// (3) Let h be the largest n.x over the cell. The cells that meet the plane have voxels within h of it. If h < |n.C|,
//     these are at most two of each line: z, and the neighbor of z beyond the plane.
// core/scan finds the lines within (2), their z, and a second voxel where h allows one. The z of (1) are decided, and
// so are most second voxels: see SecondVoxels in core/scan/cover_bounds-inl.h. The others are candidates. A pair of
// voxel and triangle is tested only if no other triangle has covered the voxel.
//
// Such a test takes integers on each separating axis (core/supercover/supercover.h).
#ifndef LATVOX_CORE_SUPERCOVER_NEAR_CELLS_H_
#define LATVOX_CORE_SUPERCOVER_NEAR_CELLS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/digitize/principal_scan.h"
#include "core/lattice/integer_cell.h"
#include "core/tile/tile_bits.h"
#include "core/tile/voxel_triangle.h"

namespace latvox {

// With steps g of the cell (CellSegments), c in lattice units from a voxel, and U = kLatticeUnit, the axes are
//   plane           n                        reach U / (2 parts) * sum |n . g|
//   facet           f, parallel to g x g'    the same with f, rounded down
//   edge d, zone g  d x g                    U / (2 parts) * sum |d . (g x g')| = U / (2 parts) * sum weight |d . f|
class NearCells {
 public:
  static constexpr size_t kFacets = kMaxFacets / 2;
  struct Facet {
    Vec3i normal;
    int32_t reach;
  };
  struct Constants {
    std::vector<Vec3i> steps;
    std::vector<Facet> facets;
    std::array<std::array<int32_t, kFacets>, kMaxZones> weights{};  // of facets, for each zone, times the numerator
    int32_t numerator, denominator;                                 // U / (2 parts); products with g have the latter
  };

  // Returns nullopt for cells of large integers, and for those that meet a neighbor without a frame, if there are any.
  static std::optional<NearCells> Of(const IntegerCell& cell);

  const CellSegments& segments() const { return segments_; }
  const std::vector<ScanFrame>& frames() const { return frames_; }  // of all neighbors whose cells meet
  const Vec3i& steps() const { return steps_; }                     // the largest |entry| of these, per axis
  int32_t most_extent() const { return most_extent_; }              // of triangles, lattice units per axis

  // Keeps the pairs whose cell meets the triangle, in any order.
  // Precondition: the triangles have an area, and no larger extent than most_extent(). The voxels are candidates of
  // their scan (FindCoverCandidates).
  void KeepMeeting(const SnappedMesh& mesh, const BitsLayout& layout, std::vector<VoxelTriangle>& pairs) const;

 private:
  CellSegments segments_;
  std::vector<ScanFrame> frames_;
  Vec3i steps_{};
  Constants constants_;
  int32_t most_extent_ = 0;
};

}  // namespace latvox

#endif  // LATVOX_CORE_SUPERCOVER_NEAR_CELLS_H_
