// What a job will cost, told from its mesh alone.
#ifndef LATVOX_CORE_VOXELIZER_ESTIMATE_H_
#define LATVOX_CORE_VOXELIZER_ESTIMATE_H_

#include "core/lattice/grid.h"
#include "core/mesh/mesh.h"
#include "core/voxelizer/voxelizer.h"

namespace latvox {

// Estimates how many voxels a job finds: about as many as it delivers, but those that several triangles share count as
// often. A surface of area A has between A / h^2 and 2 A / h^2 voxels, h the voxel size, for all the common lattices
// and every k; this is the upper one, within the region's volume, of a shard its part. The thesis's algorithms have
// some along the edges of triangles without area, too, whatever the region. One pass over the triangles. Precondition:
// Validate(mesh) is OK.
double EstimateVoxels(const TriangleMesh& mesh, const Grid& grid, const VoxelizeOptions& options);

// Estimates how many lattice points a job looks at, as often as it does: a band's those within its width of each
// triangle, of a shard its part, brute force all those in the boxes around triangles, which takes one pass, as above;
// the others about those that they find.
//   voxels   what EstimateVoxels has told
double EstimateVisits(const TriangleMesh& mesh, const Grid& grid, const VoxelizeOptions& options, double voxels);

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_ESTIMATE_H_
