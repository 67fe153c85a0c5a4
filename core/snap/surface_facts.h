// What a snapped mesh is as a surface.
#ifndef LATVOX_CORE_SNAP_SURFACE_FACTS_H_
#define LATVOX_CORE_SNAP_SURFACE_FACTS_H_

#include <cstdint>

#include "core/snap/snap.h"

namespace latvox {

struct SurfaceFacts {
  uint64_t degenerate_triangles = 0;  // no area after snapping
  bool closed = false;                // every edge, by position, in an even number of triangles
};

// `closed` welds by position, which codecs' duplicated vertices do not disturb. It is never denied to a mesh that is
// closed; one that is not gets it with a probability of 2^-126 at most, as far as hashes of positions pass for random.
// They are fixed: a mesh could be made to be taken for closed.
SurfaceFacts FactsOf(const SnappedMesh& mesh, const std::atomic<bool>& cancelled = kNeverCancelled);

}  // namespace latvox

#endif  // LATVOX_CORE_SNAP_SURFACE_FACTS_H_
