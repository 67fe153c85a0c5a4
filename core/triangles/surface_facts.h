// What a snapped mesh is as a surface.
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
  bool closed = false;                // every edge, by position, in an even number of triangles
};

// The same in the making: triangles may be added in any order, and sums of parts added up, all on the same kernels, of
// which each kind has its own hash.
struct SurfaceSums {
  //   count   triangles from the `first` one on
  void Add(const SnappedMesh& mesh, size_t first, size_t count);
  // Fills the list with these, too, since their corners are at hand: CornerList::kMost at most.
  //   origin   as for CornerList::SetCorners
  void AddAndList(const SnappedMesh& mesh, size_t first, size_t count, const Vec3i& origin, CornerList& list);
  void Add(const SurfaceSums& other);
  SurfaceFacts Facts() const;

  // For the kernels: two polynomials in GF(2)[x], of degrees below 64.
  using Hash = std::array<uint64_t, 2>;
  uint64_t degenerate = 0;
  std::array<Hash, 2> products{};  // of each half, the 128 bits of the sum of (a + b)(a + c)
  Hash corners{};                  // the sum of a
};

// `closed` welds by position, which codecs' duplicated vertices do not disturb. It is never denied to a mesh that is
// closed; one that is not gets it with a probability of 2^-126 at most, as far as hashes of positions pass for random.
// They are fixed: a mesh could be made to be taken for closed.
SurfaceFacts FactsOf(const SnappedMesh& mesh, StopSignal stop = {});

}  // namespace latvox

#endif  // LATVOX_CORE_TRIANGLES_SURFACE_FACTS_H_
