// Estimates what the walks of a request need, from its mesh alone. All are 0 without a walk. Once stopped, they return
// soon, with meaningless values.
#ifndef LATVOX_CORE_VOXELIZER_WALK_ESTIMATE_H_
#define LATVOX_CORE_VOXELIZER_WALK_ESTIMATE_H_

#include "core/base/stop_signal.h"
#include "core/lattice/grid.h"
#include "core/mesh/mesh.h"
#include "core/request/request.h"
#include "core/voxelizer/estimate.h"

namespace latvox {

// Returns how many walks the request takes at most: one for each label, or one. A label is the number of a vertex.
// Takes one pass over the vertices.
double MostWalks(const TriangleMesh& mesh, const VoxelRequest& request, StopSignal stop = {});

// An upper bound on the number of tiles that the walks find walls in or near, whatever part is delivered. A tile counts
// for each walk. Takes one pass over the triangles, and up to 24 MiB; none where few tiles are in the mesh's box, or
// the mesh has more than kMaxWalkLabels labels, which a job refuses. Precondition: CheckMesh(mesh) is OK.
//   extent   the mesh's
//   walks    as MostWalks returns
double MostWallTiles(const TriangleMesh& mesh, const MeshExtent& extent, const Grid& grid, const VoxelRequest& request,
                     double walks, StopSignal stop = {});

// An upper bound on the number of points in which a walk may search for a leak, except for rounding: those of the
// mesh's box, which also holds what `close` keeps the walk out of.
double MostWalkPoints(const MeshExtent& extent, const Grid& grid, const VoxelRequest& request);

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_WALK_ESTIMATE_H_
