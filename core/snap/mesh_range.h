// How far a mesh reaches, in lattice coordinates and in the world.
#ifndef LATVOX_CORE_SNAP_MESH_RANGE_H_
#define LATVOX_CORE_SNAP_MESH_RANGE_H_

#include "core/base/stop_signal.h"
#include "core/mesh/mesh.h"
#include "core/snap/lattice_map.h"

namespace latvox {

// The range of the vertices that triangles use; meaningless once cancelled. Precondition: CheckMesh(mesh), unless
// cancelled.
LatticeRange RangeOf(const TriangleMesh& mesh, const LatticeMap& map, StopSignal stop);

// The same in world coordinates.
Bounds BoundsOf(const TriangleMesh& mesh, StopSignal stop = {});

}  // namespace latvox

#endif  // LATVOX_CORE_SNAP_MESH_RANGE_H_
