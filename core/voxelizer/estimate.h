// Estimates a job's cost from its mesh alone. Once stopped, estimates return soon, with meaningless values.
#ifndef LATVOX_CORE_VOXELIZER_ESTIMATE_H_
#define LATVOX_CORE_VOXELIZER_ESTIMATE_H_

#include <cstdint>

#include "core/base/stop_signal.h"
#include "core/lattice/grid.h"
#include "core/mesh/mesh.h"
#include "core/voxelizer/voxelizer.h"

namespace latvox {

// The facts about a mesh that all estimates need.
struct MeshExtent {
  Bounds bounds;        // of the vertices of triangles
  double area = 0;      // of all triangles, world units squared
  double longest = 0;   // edge, world units
  double thinnest = 0;  // the least height of a triangle over its longest edge, world units; points do not count
};

// Takes one pass over the vertices, and one or two over the triangles. Precondition: CheckMesh(mesh) is OK.
MeshExtent ExtentOf(const TriangleMesh& mesh, StopSignal stop = {});

// Estimates the number of voxels that a job delivers. A voxel of several triangles counts once for each.
//
// A surface of area A has between A / h^2 and 2 A / h^2 voxels, with the voxel size h, for all common lattices and
// every k. Needles, which are thinner than a voxel, have up to 4.5 times as many, but about one for each voxel size of
// their length. The estimate is the upper bound, limited by the volumes of the region and of the bounds; a shard gets
// its part of that. A supercover also has some voxels for every triangle, however small. The interior of a solid counts
// as large as possible: a ball with that surface, or the mesh's bounding box. For a mesh that is not closed, the box is
// the only bound. The thesis's algorithms also have some voxels along the edges of triangles without area, whatever the
// region.
//
// Takes up to two passes over the triangles. Precondition: CheckMesh(mesh) is OK.
//   extent   the mesh's
double EstimateVoxels(const TriangleMesh& mesh, const MeshExtent& extent, const Grid& grid, const VoxelRequest& request,
                      StopSignal stop = {});

// Estimates how many lattice points a job looks at; a point counts each time. Takes a few passes, as above.
//
//   band          the points within its width of each triangle; a shard gets its part
//   brute force   all points in the boxes around triangles
//   supercover    its voxels, and for each triangle the number that takes as long as its separating axes
//   walk          its surface once more, and the distances that `close` asks for, whatever part is delivered
//   fields        also the points that take as long as the search for each voxel's nearest triangle
//   fraction      also the points that take as long as a count of the finer points near the mesh; with labels, as
//                 the counts for those nearby, and as the numbers of all
//   others        their voxels, each once for each triangle; for needles the number that takes as long as their rows,
//                 and, where triangles fill a volume, the number that takes as long as thinning
//
//   extent   the mesh's
double EstimateVisits(const TriangleMesh& mesh, const MeshExtent& extent, const Grid& grid, const VoxelRequest& request,
                      StopSignal stop = {});

// Returns at least as many visits as cost the time before a job's first tile: a shard or a small region takes that of
// the whole.
//   visits           as EstimateVisits returns
//   line_crossings   as EstimateLineCrossings returns
//   wall_tiles       as MostWallTiles returns
double WithPreparation(double visits, const VoxelRequest& request, double line_crossings, double wall_tiles);

// Estimates the milliseconds of a job on one core. `visits`: as WithPreparation says, which counts the work of fields.
double EstimateMilliseconds(const VoxelRequest& request, uint64_t triangles, double visits);

// Estimates the number of crossings with lines along k that a job finds and keeps before its first tile: at most some
// twice the number for a mesh that faces the lines everywhere, and more for slivers. Takes up to two passes, as above.
//
//   no inside     0
//   may be open   those of all lines, because a job counts unbalanced lines of the whole mesh
//   others        those of one line in 64^2 through the part's box; a shard keeps all of them
//   fraction      also the same in the finer lattice
double EstimateLineCrossings(const TriangleMesh& mesh, const Grid& grid, const VoxelRequest& request,
                             StopSignal stop = {});

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_ESTIMATE_H_
