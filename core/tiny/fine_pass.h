// One pass over a fine mesh. It does all work that is possible triangle by triangle, before there are tiles.
#ifndef LATVOX_CORE_TINY_FINE_PASS_H_
#define LATVOX_CORE_TINY_FINE_PASS_H_

#include <cstdint>
#include <vector>

#include "core/base/stop_signal.h"
#include "core/base/uninitialized.h"
#include "core/digitize/principal_scan.h"
#include "core/snap/snap.h"
#include "core/tile/tile_links.h"
#include "core/tiny/fineness.h"
#include "core/triangles/surface_facts.h"

namespace latvox {

struct FineTriangles {
  std::vector<uint32_t> kept;  // triangles that are left to be digitized one by one, ascending
  SurfaceFacts facts;
};

// Goes through the mesh with all threads of the arena. `fineness` decides which triangles are left to be digitized one
// by one. It leaves out those that no lattice line can meet (core/tiny/touching.h), or tiny ones, whose links go to
// `links` (core/tiny/tiny.h), or none.
//   box       local voxels; links with a nearer end outside are not wanted
//   is_tiny   if not null and most are tiny, it is sized and set for all triangles: 0 for those to be digitized one by
//             one. Then tiny ones that lines may meet are kept, too, as by Sift
// Once the job is cancelled, parts are missing.
FineTriangles SortOutFine(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const Fineness& fineness,
                          const IndexBox& box, StopSignal stop, TileLinks& links,
                          UninitializedVector<uint8_t>* is_tiny);

// Whether lanes can find the tiny triangles of a mesh, and their voxels can be packed. The scalar kernel has no lanes.
bool CanFindTiny(const SnappedMesh& mesh, const TileLinks& links);

// Does the same as SortOutFine for a supercover where cells are boxes along the lattice axes. It leaves out tiny
// triangles, whose cells go to `links` (core/tiny/tiny_cover.h). Precondition: CanFindTiny(mesh, links).
FineTriangles SortOutFineCover(const SnappedMesh& mesh, const IndexBox& box, StopSignal stop, TileLinks& links);

}  // namespace latvox

#endif  // LATVOX_CORE_TINY_FINE_PASS_H_
