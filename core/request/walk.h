// Sets that a walk decides: from point to k-neighbor, never onto a point of the surface.
#ifndef LATVOX_CORE_REQUEST_WALK_H_
#define LATVOX_CORE_REQUEST_WALK_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/vec.h"
#include "core/request/fields.h"
#include "core/request/solid.h"

namespace latvox {

// No step between two points outside of a k-separating surface crosses the mesh. So what the walk does not reach is cut
// off, whatever the orientation, the overlaps and the inner walls of the mesh.
//
// With `close` G > 0, the walk also keeps out of all points within G/2 of the mesh. Afterwards the reached points grow:
// a point outside of the surface's voxels is reached as well if it lies within G/2 of a reached point. The straight way
// between the two never meets the mesh, because reached points are farther than G/2 from it.

// The points that no walk from outside of the mesh's box reaches.
//
// With labels, each label has the set of its own triangles alone. The set is the union of these. A point of several has
// the label with the highest priority. A point that only several labels cut off belongs to none.
struct Enclosed {
  SolidSurface surface = SolidSurface::kSeparating;  // kNone leaves out the surface's voxels; not kSupercover
  double close = 0;                                  // G, world units, finite, at least 0
  std::optional<Vec3d> leak_from = std::nullopt;     // world: report a way from the point nearest to it to the outside
  // As in Solid.
  std::optional<Field> labels = std::nullopt;
  std::vector<uint32_t> priority = {};
};

// The points that a walk from the lattice point nearest to `seed` reaches, within the mesh's box.
struct Connected {
  Vec3d seed{};                // world
  double close = 0;            // G, as above
  bool allow_outside = false;  // otherwise it is an error if the walk gets outside
};

}  // namespace latvox

#endif  // LATVOX_CORE_REQUEST_WALK_H_
