// Facts about a job's mesh before its first tile.
#ifndef LATVOX_CORE_VOXELIZER_JOB_FACTS_H_
#define LATVOX_CORE_VOXELIZER_JOB_FACTS_H_

#include <optional>

#include "core/snap/snap.h"
#include "core/triangles/surface_facts.h"
#include "core/voxelizer/voxelizer.h"
#include "core/voxelizer/world_box.h"

namespace latvox {

// Returns the facts of a job that delivers the voxels of `region` (local; empty if there are none) within `bounds`.
JobFacts FactsOfJob(const SnappedMesh& mesh, const SurfaceFacts& surface, const IndexBox& region,
                    const std::optional<WorldBox>& bounds);

// Returns whether the tile meets the box.
bool HasTile(const IndexBox& box, const Vec3i& tile_ijk);

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_JOB_FACTS_H_
