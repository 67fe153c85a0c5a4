// Whether a mesh has an inside at all.
#ifndef LATVOX_CORE_SOLID_BALANCE_H_
#define LATVOX_CORE_SOLID_BALANCE_H_

#include <cstdint>

#include "core/base/stop_signal.h"
#include "core/request/solid.h"
#include "core/snap/snap.h"

namespace latvox {

// Whether every edge, by position, is as often an edge of triangles in one sense as in the other: then winding numbers
// do not depend on the path. As SurfaceFacts::closed, by hashes: never denied to a mesh of which it is true, and of
// another one said with a probability of 2^-64 at most, as far as hashes of positions pass for random.
bool IsOriented(const SnappedMesh& mesh, StopSignal stop = {});

// How many lattice lines along k end unbalanced: their signed crossings have an odd sum, or one other than 0. Of a mesh
// that is closed (kParity) or oriented (kWinding) there is none; of another one there may be none, if no line passes
// through its holes. Memory: O(triangles).
uint64_t CountUnbalancedLines(const SnappedMesh& mesh, InteriorRule rule, StopSignal stop = {});

}  // namespace latvox

#endif  // LATVOX_CORE_SOLID_BALANCE_H_
