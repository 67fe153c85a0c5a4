// The voxels that a set of triangles may contribute.
//
// Read these rooms in this order, from the rule to its fastest forms. Each form gives the same result as those before.
//   core/digitize/crossing.h        the crossing rule: one triangle, one direction
//   core/digitize/principal_scan.h  one triangle, all directions: candidates on the lines along its principal direction
//   core/digitize/star.h            which of these candidates it contributes; plain C++ stops here
//   line_scan.h                     that scan in integers that are linear over the lines, and fit lanes of 32 bits
//   line_scan_lanes-inl.h           many triangles' scans in lanes
//   row_spans-inl.h                 the lines of long rows that are within rims and edges
//   cover_bounds-inl.h              rims and second voxels of a supercover's lines
//   batch_lines-inl.h, scan_batch-inl.h  the lines of many small triangles together
//   scan_single-inl.h               the lines of one triangle, in blocks; candidates.cc combines all of these
//   stars.h                         many stars in lanes
//   open_stars.h                    which stars may reach a voxel outside of a set
//   triangle_boxes.h                which triangles may have a voxel
//   core/tiny                       triangles smaller than voxels
// The supercover (core/supercover) is another rule.
#ifndef LATVOX_CORE_SCAN_CANDIDATES_H_
#define LATVOX_CORE_SCAN_CANDIDATES_H_

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/bytes_of.h"
#include "core/base/stop_signal.h"
#include "core/digitize/principal_scan.h"
#include "core/lattice/integer_cell.h"
#include "core/scan/triangle_boxes.h"
#include "core/snap/snap.h"
#include "core/tile/tile_bits.h"

namespace latvox {

// Voxels are numbers of one BitsLayout, below 2^kNumberBits. The bits above hold the triangle's place in its run.
struct Candidates {
  // Up to kMaxRun triangles. Their entries end at these positions of the lists, and begin where the run before ends.
  struct Run {
    uint32_t first;                 // index in `triangles`
    uint32_t crossed_end, rim_end;  // in `farther` and in `rim`
  };
  static constexpr size_t kMaxRun = size_t{1} << (32 - kNumberBits);

  // Links along principal directions that a triangle crosses, from nearer[n], a voxel of the surface, to farther[n].
  // For a supercover, `nearer` has voxels of it, and `farther` those second ones of lines that the scan leaves open.
  NumberList nearer, farther;
  // Voxels on lattice lines that pass a triangle closely. A star decides whether the triangle contributes them.
  NumberList rim;
  std::vector<Run> runs;
  std::vector<uint32_t> triangles;  // the triangles' numbers, in the order of the runs
  // Boxes of all triangles, in that order, if the triangles are large enough for that to pay; else of fewer.
  TriangleBoxes boxes;

  void Reserve(size_t more) {
    for (NumberList* list : {&nearer, &farther, &rim}) list->Reserve(more);
  }
  size_t size() const { return nearer.size() + rim.size(); }
  size_t Bytes() const {
    return nearer.Bytes() + farther.Bytes() + rim.Bytes() + BytesOf(runs) + BytesOf(triangles) + boxes.Bytes();
  }
  // Returns the triangle at a place of the run.
  uint32_t TriangleAt(const Run& run, size_t place) const { return triangles[run.first + place]; }
  void EndRun(std::span<const uint32_t> of) {
    runs.push_back({static_cast<uint32_t>(triangles.size()), static_cast<uint32_t>(farther.size()),
                    static_cast<uint32_t>(rim.size())});
    triangles.insert(triangles.end(), of.begin(), of.end());
  }
  void Clear() {
    for (NumberList* list : {&nearer, &farther, &rim}) list->Clear();
    runs.clear();
    triangles.clear();
    boxes.Clear();
  }
};

// Where candidates are wanted, and when a search ends.
struct SearchLimits {
  IndexBox box;       // lies in `layout`
  BitsLayout layout;  // of the voxels' numbers
  StopSignal stop;
  size_t enough;  // once there are so many candidates in all, the current triangles, up to 256, are the last
};

// Appends the candidates in the box of the triangles. Every voxel in the box that one of them contributes is there with
// that triangle, and few others are. They come in any order.
// Returns the number of triangles done, from the first on, at least one. Once the job is cancelled, returns early with
// a meaningless result.
size_t FindCandidates(const SnappedMesh& mesh, std::span<const uint32_t> triangles,
                      const std::vector<ScanFrame>& frames, const SearchLimits& limits, Candidates& candidates);

// What the scan for a supercover needs of the lattice's cell.
// Precondition: core/supercover/near_cells.h applies to the cell.
struct CoverShape {
  const std::vector<ScanFrame>& frames;  // of all neighbors whose cells meet
  const CellSegments& cell;
  int32_t most_extent;  // of a triangle, lattice units
};

// Does the same for the supercover. Each voxel of the box whose cell meets one of the triangles is in `nearer`, or with
// that triangle in `farther` or `rim`. All of `nearer` have such cells.
//   left     gets the triangles that this does not handle: larger ones, those without area, and those that vectors
//            cannot hold. Plain C++ leaves all.
// Precondition: voxels a step beyond the box have numbers, too.
size_t FindCoverCandidates(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const CoverShape& shape,
                           const SearchLimits& limits, Candidates& candidates, std::vector<uint32_t>& left);

}  // namespace latvox

#endif  // LATVOX_CORE_SCAN_CANDIDATES_H_
