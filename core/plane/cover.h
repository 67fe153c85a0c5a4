// Curves as sets of crossed links, pixel sets as covers of them.
//
// A set of pixels is k-tunnel-free (thesis section 2.2) iff every crossed link has an end in it, that is, iff it is a
// vertex cover. It is k-minimal iff no pixel can leave, that is, iff the cover is minimal.
#ifndef LATVOX_CORE_PLANE_COVER_H_
#define LATVOX_CORE_PLANE_COVER_H_

#include <compare>
#include <cstdint>
#include <vector>

#include "core/base/stop_signal.h"
#include "core/lattice/lattice.h"
#include "core/plane/polyline.h"

namespace latvox {

// The ends of a link, low < high lexicographically.
struct PlaneLink {
  Vec2i low, high;
  auto operator<=>(const PlaneLink&) const = default;
};

struct PlaneCrossings {
  std::vector<PlaneLink> links;  // every link that is crossed at least once; sorted, without duplicates
  std::vector<Vec2i> nearer;     // the nearer end of every crossing: Delta_k; sorted, without duplicates
};

// Crossings of all segments with the links along all frames, in local pixels.
PlaneCrossings FindCrossings(const std::vector<Segment>& segments, const std::vector<PlaneFrame>& frames,
                             StopSignal stop = {});

// For each of the four parity classes (i&1)<<1 | (j&1) in ascending order, removes every pixel of the class whose
// crossed links all have their other end in the set. No two pixels of a class are neighbors, so the order within a
// class does not matter. A pixel that its pass keeps stays essential, because the set only shrinks. The result covers
// every link that was covered, and has no redundant pixel.
//   links, pixels   sorted, without duplicates
void Thin(const std::vector<PlaneLink>& links, std::vector<Vec2i>& pixels, StopSignal stop = {});

struct PlaneVerdict {
  uint64_t tunnels = 0;    // crossed links without an end in the set
  uint64_t redundant = 0;  // pixels that could leave, one at a time, without a tunnel; those on no crossed link count
};

// Checks any set of pixels against the crossed links; both sorted, without duplicates.
PlaneVerdict Judge(const std::vector<PlaneLink>& links, const std::vector<Vec2i>& pixels, StopSignal stop = {});

}  // namespace latvox

#endif  // LATVOX_CORE_PLANE_COVER_H_
