// Triangle meshes as they arrive: any set of triangles, open or closed, self-intersecting, non-manifold.
#ifndef LATVOX_CORE_MESH_MESH_H_
#define LATVOX_CORE_MESH_MESH_H_

#include <array>
#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "core/base/stop_signal.h"
#include "core/base/uninitialized.h"
#include "core/base/vec.h"

namespace latvox {

struct TriangleMesh {
  PaddedVector<Vec3f> vertices;                    // world units; new ones are indeterminate until they are assigned
  std::vector<std::array<uint32_t, 3>> triangles;  // indices into `vertices`
  // The numbers that voxels may carry: for each vertex one number an attribute, vertex after vertex.
  std::vector<uint32_t> attributes = {};
};

// World-space box, closed on both sides.
struct Bounds {
  Vec3d min, max;
  // Length of the longest side, world units.
  double LongestSide() const;
};

// Returns INVALID_ARGUMENT, naming the element, for a mesh without triangles, an index out of range or a vertex that is
// not finite.
absl::Status CheckMesh(const TriangleMesh& mesh, StopSignal stop = {});

}  // namespace latvox

#endif  // LATVOX_CORE_MESH_MESH_H_
