// Triangles that cross one lattice line of each direction at most.
#ifndef LATVOX_CORE_DIGITIZE_TINY_H_
#define LATVOX_CORE_DIGITIZE_TINY_H_

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "core/digitize/principal_scan.h"
#include "core/digitize/sift.h"
#include "core/snap/snap.h"
#include "core/tile/tile_bits.h"

namespace latvox {

// Crossed lattice edges: from nearer[n], which is the surface's, to farther[n]. Voxels are numbers of one BitsLayout.
struct Crossings {
  NumberList nearer, farther;

  void Clear() {
    nearer.Clear();
    farther.Clear();
  }
};

// Appends all edges, in all directions, that the tiny ones of the triangles cross, with nearer ends in `box`. The
// triangles that are left go to `others`, in their order.
//   met  of all triangles of the mesh, as Sift sets it (core/digitize/sift.h)
//
// No candidates, no stars: where triangles are smaller than voxels, few lines lie between their corners at all.
void FindTinyCrossings(const SnappedMesh& mesh, std::span<const uint32_t> triangles, std::span<const MetLines> met,
                       const std::vector<ScanFrame>& frames, const IndexBox& box, const BitsLayout& layout,
                       const std::atomic<bool>& cancelled, Crossings& crossings, std::vector<uint32_t>& others);

}  // namespace latvox

#endif  // LATVOX_CORE_DIGITIZE_TINY_H_
