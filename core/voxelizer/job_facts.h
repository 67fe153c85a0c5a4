// What a job says of its mesh before its first tile.
#ifndef LATVOX_CORE_VOXELIZER_JOB_FACTS_H_
#define LATVOX_CORE_VOXELIZER_JOB_FACTS_H_

#include <optional>

#include "core/snap/snap.h"
#include "core/triangles/surface_facts.h"
#include "core/voxelizer/voxelizer.h"
#include "core/voxelizer/world_box.h"

namespace latvox {

// Facts of a job that delivers the voxels of `region` (local; empty if none) within `bounds`.
JobFacts FactsOfJob(const SnappedMesh& mesh, const SurfaceFacts& surface, const IndexBox& region,
                    const std::optional<WorldBox>& bounds);

// Whether the tile meets the box.
bool HasTile(const IndexBox& box, const Vec3i& tile_ijk);

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_JOB_FACTS_H_
