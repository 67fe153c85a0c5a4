// The lattice edges that tiny triangles cross, of a whole mesh.
//
// Where triangles are smaller than voxels, few lines lie between their corners at all: the crossings of all directions
// are found in one pass over the mesh, and these, not the triangles, are sorted into tiles. No candidates, no stars.
#ifndef LATVOX_CORE_DIGITIZE_TINY_H_
#define LATVOX_CORE_DIGITIZE_TINY_H_

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/uninitialized.h"
#include "core/digitize/fineness.h"
#include "core/digitize/principal_scan.h"
#include "core/digitize/sift.h"
#include "core/snap/snap.h"
#include "core/tile/tile_edges.h"

namespace latvox {

// Gives `edges` all edges, in all directions, that the tiny ones of the triangles cross. Others go to `kept`, as Sift
// says.
//   box    local voxels: of edges with a nearer end outside, nothing is wanted
void FindTinyCrossings(const SnappedMesh& mesh, std::span<const uint32_t> triangles,
                       const std::vector<ScanFrame>& frames, const IndexBox& box, TileEdges& edges,
                       std::vector<uint32_t>& kept, uint8_t* is_tiny);

// The triangles of the mesh that are left to be digitized one by one, ascending, found by all threads of the arena: by
// `fineness`, all but those that no lattice line can meet (core/digitize/touching.h), all but tiny ones, whose edges
// go to `edges`, or all.
//   is_tiny   if not null and most are tiny, sized and set for all triangles: 0 for those to be digitized one by one;
//             then tiny ones that lines may meet are returned, too, as Sift says
// Some are missing once the job is cancelled.
std::vector<uint32_t> SortOutFine(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames,
                                  const Fineness& fineness, const IndexBox& box, const std::atomic<bool>& cancelled,
                                  TileEdges& edges, UninitializedVector<uint8_t>* is_tiny);

}  // namespace latvox

#endif  // LATVOX_CORE_DIGITIZE_TINY_H_
