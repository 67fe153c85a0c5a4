// The thesis's own algorithms for lines, on any lattice, for comparison with the crossing rule.
//
// All work segment by segment, on local pixels, and return sets: sorted, without duplicates, not thinned.
#ifndef LATVOX_CORE_PLANE_THESIS_LINES_H_
#define LATVOX_CORE_PLANE_THESIS_LINES_H_

#include <cstdint>
#include <vector>

#include "core/base/stop_signal.h"
#include "core/lattice/lattice.h"
#include "core/plane/polyline.h"

namespace latvox {

// Returns the segments with both ends moved to their nearest pixels, like vertices in section 4.6. Halfway points go to
// one of the nearest.
std::vector<Segment> RoundToPixels(const std::vector<Segment>& segments, const PlaneLattice& lattice);

// Brute force (sections 3.1, 4.1, 4.2): tests every pixel in the bounding box and a margin. It keeps pixels with -t <
// n.z + D <= t whose center lies between the segment's two ends, and pixels within R of an end. R is the largest
// interface distance |q|/2 of a k-neighbor.
//   (1) contains the nearer end of every crossed link: it is k-separating   (2) in general not k-minimal at ends
// Integers decide on the slab. Discs are closed, and reach further by the lattice's symmetry tolerance. Doubles decide
// whether a pixel's foot lies between the ends. An error there does not matter: within t <= R of an end, the pixel is
// in the disc.
std::vector<Vec2i> BruteForceLines(const std::vector<Segment>& segments, const PlaneLattice& lattice, int k,
                                   StopSignal stop = {});

// The number of pixels that BruteForceLines will test.
uint64_t BruteForceCost(const std::vector<Segment>& segments, const PlaneLattice& lattice, int k);

// The incremental form (sections 4.3, 4.4). It visits the lattice lines along the principal direction C, from that of
// one end to that of the other. On each, it finds the one pixel with -t < n.z + D <= t by adding delta k. A segment of
// length zero is its pixel.
//   (1) exactly one pixel on each lattice line along C
//   (2) k-separating, also at seams between segments, without the rule of section 4.5. For |r[0].q| <= 1, a link along
//       q that crosses the segment has both ends on lattice lines from one end's to the other's. So its nearer end is
//       in the set. |r[0].q| is larger only if q and C are the two diagonals of a rectangle. Then it is 2, the link's
//       middle is on a lattice line between its ends', and the end on the segment's side of it is the nearer one.
// Precondition: both ends of every segment are pixels (RoundToPixels).
std::vector<Vec2i> IncrementalLines(const std::vector<Segment>& segments, const PlaneLattice& lattice, int k,
                                    StopSignal stop = {});

// The line of Ibanez, Hamitouche and Roux (section 4.6, reference 26). It goes from one end to the other by steps
// between (1-k)-neighbors, and each time takes the one of two steps that stays nearer to the segment. Bresenham's
// octant is the cone between the two steps. In the plane, k-steps cannot pass a curve of (1-k)-steps, and the set
// equals that of IncrementalLines. Precondition: as IncrementalLines.
std::vector<Vec2i> IbanezLines(const std::vector<Segment>& segments, const PlaneLattice& lattice, int k,
                               StopSignal stop = {});

// One such line, in order from one pixel to the other, both included.
std::vector<Vec2i> IbanezLine(const Vec2i& from, const Vec2i& to, const PlaneLattice& lattice, int k);

}  // namespace latvox

#endif  // LATVOX_CORE_PLANE_THESIS_LINES_H_
