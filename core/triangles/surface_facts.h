// Facts about a snapped mesh as a surface.
#ifndef LATVOX_CORE_TRIANGLES_SURFACE_FACTS_H_
#define LATVOX_CORE_TRIANGLES_SURFACE_FACTS_H_

#include <array>
#include <cstdint>

#include "core/base/stop_signal.h"
#include "core/snap/snap.h"
#include "core/triangles/corner_list.h"

namespace latvox {

struct SurfaceFacts {
  uint64_t degenerate_triangles = 0;  // no area after snapping
  bool closed = false;                // every edge, by position, belongs to an even number of triangles
};

// Partial sums of the facts. Triangles may be added in any order, and sums of parts added up, if all come from the same
// kernel, because each kind of kernel has its own hash.
struct SurfaceSums {
  //   count   triangles from the `first` one on
  void Add(const SnappedMesh& mesh, size_t first, size_t count);
  // Also fills the list with these triangles, at most CornerList::kMost, because their corners are at hand.
  //   origin   as for CornerList::SetCorners
  void AddAndList(const SnappedMesh& mesh, size_t first, size_t count, const Vec3i& origin, CornerList& list);
  void Add(const SurfaceSums& other);
  SurfaceFacts Facts() const;

  // For the kernels: two polynomials in GF(2)[x], of degrees below 64.
  using Hash = std::array<uint64_t, 2>;
  uint64_t degenerate = 0;
  std::array<Hash, 2> products{};  // for each half, the 128 bits of the sum of (a + b)(a + c)
  Hash corners{};                  // the sum of a
};

// `closed` welds by position, so duplicated vertices of codecs do not matter. A closed mesh is always found closed.
// Another mesh is mistaken for a closed one with a probability of at most 2^-126, as far as hashes of positions are
// random. The hashes are fixed, so a mesh could be constructed that is mistaken for a closed one.
SurfaceFacts FactsOf(const SnappedMesh& mesh, StopSignal stop = {});

}  // namespace latvox

#endif  // LATVOX_CORE_TRIANGLES_SURFACE_FACTS_H_
