// What a job will cost, told from its mesh alone. Once cancelled, estimates come soon, and mean nothing.
#ifndef LATVOX_CORE_VOXELIZER_ESTIMATE_H_
#define LATVOX_CORE_VOXELIZER_ESTIMATE_H_

#include "core/base/stop_signal.h"
#include "core/lattice/grid.h"
#include "core/mesh/mesh.h"
#include "core/voxelizer/voxelizer.h"

namespace latvox {

// What estimates know of a mesh, whatever the job.
struct MeshExtent {
  Bounds bounds;    // of the vertices that triangles use
  double area = 0;  // of all triangles, world units squared
};

// A pass over the vertices and one over the triangles, or two. Precondition: CheckMesh(mesh) is OK.
MeshExtent ExtentOf(const TriangleMesh& mesh, StopSignal stop = {});

// Estimates how many voxels a job finds: about as many as it delivers, but those that several triangles share count as
// often. A surface of area A has between A / h^2 and 2 A / h^2 voxels, h the voxel size, for all the common lattices
// and every k; this is the upper one, within the region's volume and the bounds', of a shard its part. A supercover has
// some for every triangle, too, however small. The inside of a solid is taken for as large as it can be: a ball with
// that surface, or the mesh's bounding box, which is all that bounds that of a mesh that is not closed. The thesis's
// algorithms have some along the edges of triangles without area, too, whatever the region. Up to one pass over the
// triangles. Precondition: CheckMesh(mesh) is OK.
//   extent   the mesh's
double EstimateVoxels(const TriangleMesh& mesh, const MeshExtent& extent, const Grid& grid, const VoxelRequest& request,
                      StopSignal stop = {});

// Estimates how many lattice points a job looks at, as often as it does: a band's those within its width of each
// triangle, of a shard its part, brute force all those in the boxes around triangles, which takes one pass, as above; a
// supercover those that it finds, and for each triangle as many as take the time to set up its separating axes, or,
// where voxels carry attributes, the distance to it; the others about those that they find.
//   voxels   what EstimateVoxels has told
double EstimateVisits(const TriangleMesh& mesh, const Grid& grid, const VoxelRequest& request, double voxels,
                      StopSignal stop = {});

// Estimates how many crossings lattice lines along k have with the whole mesh: twice as many as if it faced them
// everywhere, and what slivers have besides. One pass, as above.
double EstimateLineCrossings(const TriangleMesh& mesh, const Grid& grid, StopSignal stop = {});

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_ESTIMATE_H_
