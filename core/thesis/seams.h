// The regions L_e and L_v of the incremental algorithms (thesis section 4.5), which keep the surface closed where
// triangles meet.
//
// The thesis: D(A+B) = D(A) u D(B) u (D(A+A') n D(B+B')), A' the part of A's plane beyond the common edge or vertex.
//
// Our reading, for meshes. A link (a segment between two k-neighbors) crosses triangle A at p. Let z be its nearer end,
// the one in A's slab (Theorem 4), at most half a link from p. If z's line along A's principal direction meets A, z is
// in D(A). Else it meets A's plane at p', outside of A, at most half a link from z. The way from p to p' leaves A
// through an edge e, and so passes from one side to the other of every other triangle B at e. B's plane separates p
// from p', so it separates one of them from z, or meets z. So z lies in the closed slab of B. And z is within R of e,
// because p and p' are within R of z. Therefore the voxels that lie
//   - within R of an edge (as Tube), and
//   - in the slab of one of the edge's triangles, and in the closed slabs of all others,
// together with all D(A), hold an end of every crossed link. In consequence
//   - vertices need nothing of their own: the way from p to p' always leaves through an edge;
//   - an edge with more than two triangles needs only what lies in all of their slabs;
//   - an edge with one triangle (a border, or a T-junction made by rounding) has no B: A's slab alone decides, which
//     keeps open meshes tunnel-free too. The thesis does not mention them.
#ifndef LATVOX_CORE_THESIS_SEAMS_H_
#define LATVOX_CORE_THESIS_SEAMS_H_

#include <vector>

#include "core/base/stop_signal.h"
#include "core/thesis/neighborhood.h"

namespace latvox {

// Emits the voxels described above for the edge from a to b.
//   normals   of the edge's triangles, as NormalOf gives them; at least one, none zero
// Precondition: a != b.
void Seam(const Vec3i& a, const Vec3i& b, const std::vector<Vec<int64_t, 3>>& normals, const Neighborhood& neighborhood,
          StopSignal stop, EmitVoxel emit);

}  // namespace latvox

#endif  // LATVOX_CORE_THESIS_SEAMS_H_
