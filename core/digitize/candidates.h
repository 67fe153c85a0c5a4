// The voxels that a set of triangles may contribute.
#ifndef LATVOX_CORE_DIGITIZE_CANDIDATES_H_
#define LATVOX_CORE_DIGITIZE_CANDIDATES_H_

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "core/digitize/principal_scan.h"
#include "core/snap/snap.h"
#include "core/tile/tile_bits.h"

namespace latvox {

// Voxels are numbers of one BitsLayout, triangles those of the mesh.
struct Candidates {
  // Edges along principal directions that a triangle crosses: nearer[n], which is the surface's, to farther[n].
  NumberList nearer, farther, crossed_by;
  // Voxels on lattice lines that pass a triangle closely: whether it contributes them is open.
  NumberList rim, passed_by;

  void Reserve(size_t more) {
    for (NumberList* list : {&nearer, &farther, &crossed_by, &rim, &passed_by}) list->Reserve(more);
  }
  void Clear() {
    for (NumberList* list : {&nearer, &farther, &crossed_by, &rim, &passed_by}) list->Clear();
  }
};

// Appends the candidates in `box`, which lies in `layout`, of the triangles: every voxel in the box that one of them
// contributes is there with that triangle, and few others are. The order is open.
// Returns early once the job is cancelled.
void FindCandidates(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const std::vector<ScanFrame>& frames,
                    const IndexBox& box, const BitsLayout& layout, const std::atomic<bool>& cancelled,
                    Candidates& candidates);

}  // namespace latvox

#endif  // LATVOX_CORE_DIGITIZE_CANDIDATES_H_
