// The way by which a walk gets outside, for a reader who looks for the hole.
#ifndef LATVOX_CORE_WALK_LEAK_H_
#define LATVOX_CORE_WALK_LEAK_H_

#include <cstdint>
#include <vector>

#include "core/base/stop_signal.h"
#include "core/base/vec.h"
#include "core/brick/brick.h"
#include "core/lattice/frame.h"
#include "core/lattice/lattice.h"
#include "core/snap/snap.h"
#include "core/walk/facts.h"

namespace latvox {

// Finds a way from `start` to the outside of the box.
//
// A point's clearance is the number of steps from it to the nearest wall. The way first climbs to points of larger
// clearance, as long as a step leads to one. From there it is one of the widest: its least clearance is as large as
// that of any. As few of its points as possible have that clearance. So it passes the hole in the middle of its widest
// opening, and keeps away from walls elsewhere. Ties go to the first step in lexicographic order.
//
//   clearance   of the box's points, i slowest: 0 for walls, otherwise any other number; used as memory
//   start       in the box, no wall, connected to the outside
// Returns the path, from the start to the first point outside; `narrowest` is its point of the least clearance behind
// the climb, in the middle of the first of several. Empty once stopped.
std::vector<Vec3i> FindWayOut(const std::vector<Frame>& frames, const IndexBox& box, std::vector<uint8_t>& clearance,
                              const Vec3i& start, StopSignal stop, Vec3i& narrowest);

// Returns the distance of a point (local) from the mesh, world units; negative if the lattice is too skewed for it.
double DistanceFromMesh(const SnappedMesh& mesh, const Lattice& lattice, const Vec3i& point, StopSignal stop);

}  // namespace latvox

#endif  // LATVOX_CORE_WALK_LEAK_H_
