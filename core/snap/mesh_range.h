// How far a mesh reaches, in lattice coordinates and in the world.
#ifndef LATVOX_CORE_SNAP_MESH_RANGE_H_
#define LATVOX_CORE_SNAP_MESH_RANGE_H_

#include <atomic>

#include "core/base/cancelled.h"
#include "core/mesh/mesh.h"
#include "core/snap/lattice_map.h"

namespace latvox {

// The range of the vertices that triangles use; once cancelled, it means nothing. Precondition: Validate(mesh), unless
// cancelled.
LatticeRange RangeOf(const TriangleMesh& mesh, const LatticeMap& map, const std::atomic<bool>& cancelled);

// The same in world coordinates.
Bounds BoundsOf(const TriangleMesh& mesh, const std::atomic<bool>& cancelled = kNeverCancelled);

}  // namespace latvox

#endif  // LATVOX_CORE_SNAP_MESH_RANGE_H_
