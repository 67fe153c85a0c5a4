// A job that finds voxels exactly: a surface, a supercover or a solid, or a band with its distances.
#ifndef LATVOX_CORE_VOXELIZER_EXACT_JOB_H_
#define LATVOX_CORE_VOXELIZER_EXACT_JOB_H_

#include <memory>

#include "core/voxelizer/exact_plan.h"
#include "core/voxelizer/voxelizer.h"

namespace latvox {

// Digitizes tile by tile, in a pipeline of units with some tiles each. Memory: the mesh, the links or cells of its tiny
// triangles, and the tiles in flight; for a solid with force_open, also all crossings of lines along k.
std::unique_ptr<VoxelizeJob> MakeExactJob(std::unique_ptr<ExactPlan> plan);

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_EXACT_JOB_H_
