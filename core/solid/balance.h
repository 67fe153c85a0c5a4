// Finds whether a mesh has an inside.
#ifndef LATVOX_CORE_SOLID_BALANCE_H_
#define LATVOX_CORE_SOLID_BALANCE_H_

#include <cstdint>
#include <span>
#include <string>

#include "core/base/stop_signal.h"
#include "core/request/solid.h"
#include "core/snap/snap.h"

namespace latvox {

// Returns whether every edge, by position, occurs equally often in both senses. Then winding numbers do not depend on
// the path. It uses hashes, like SurfaceFacts::closed: the answer is always yes for such a mesh. For another mesh it is
// yes with a probability of at most 2^-64, as far as hashes of positions are random.
bool IsOriented(const SnappedMesh& mesh, StopSignal stop = {});

// Returns words for the error of a mesh without an inside: what it lacks, if it is closed.
std::string WithoutOrientation(bool closed, InteriorRule rule);

// Returns the number of lattice lines along k that end unbalanced: the sum of their signed crossings is odd (kParity),
// or not 0 (other rules). A closed (kParity) or oriented (other rules) mesh has none. Another mesh may have none as
// well, if no line passes through its holes. Memory: O(triangles).
uint64_t CountUnbalancedLines(const SnappedMesh& mesh, InteriorRule rule, StopSignal stop = {});
// The same for some triangles of a mesh.
uint64_t CountUnbalancedLines(const SnappedMesh& mesh, std::span<const uint32_t> triangles, InteriorRule rule,
                              StopSignal stop = {});

// Some triangles of a mesh as a surface, with the same certainty as IsOriented.
struct PartBalance {
  bool closed = false;    // every edge occurs an even number of times
  bool oriented = false;  // every edge occurs equally often in both senses
};
PartBalance BalanceOf(const SnappedMesh& mesh, std::span<const uint32_t> triangles, StopSignal stop = {});

}  // namespace latvox

#endif  // LATVOX_CORE_SOLID_BALANCE_H_
