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

// Vertices are floats, as codecs store them, or doubles, for positions that floats cannot hold.
struct TriangleMesh {
  PaddedVector<Vec3f> vertices;                    // world units; new ones are indeterminate until they are assigned
  std::vector<std::array<uint32_t, 3>> triangles;  // indices of vertices
  // The numbers that voxels may carry: for each vertex one number an attribute, vertex after vertex.
  std::vector<uint32_t> attributes = {};
  PaddedVector<Vec3d> double_vertices = {};  // in place of `vertices`, which is then empty

  size_t vertex_count() const { return vertices.size() + double_vertices.size(); }
};

// Calls f with the vertices of the mesh: a const PaddedVector of Vec3f or of Vec3d.
template <class F>
decltype(auto) VisitVertices(const TriangleMesh& mesh, const F& f) {
  return mesh.double_vertices.empty() ? f(mesh.vertices) : f(mesh.double_vertices);
}

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
