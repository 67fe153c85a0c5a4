// Meshes to measure with: from files, or generated.
#ifndef LATVOX_TESTS_BENCH_MESHES_H_
#define LATVOX_TESTS_BENCH_MESHES_H_

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "core/mesh/mesh.h"

namespace latvox {

// Returns the mesh of a name:
//   box        a cube of 12 triangles, turned so that no two edges have the same slope on any axis
//   sphere:N   closed; 4 m^2 triangles of about the same size, about N in all; N from 8 to 2^26
//   wires:N    N wires of 16 long thin triangles (wires.h); N from 1 to 2^20
//   ground     a large square of two triangles, with a small object on it
//   forest:N   N tetrahedra as small as voxels; N from 1 to 2^24
//   tangle:N   N random triangles that fill a cube; N from 1 to 2^24
//   fan:N      a disk of N thin triangles; N from 3 to 2^24
//   cylinder:N a cylinder of N sides, closed (these five: shapes.h); N from 3 to 2^24
//   gears, plates, honeycomb, threads, pipes, city, shells, tree
//              parts that are designed, not scanned (parts.h)
//   a file     .drc .obj .ply .stl .glb .gltf .3ds
// Errors: INVALID_ARGUMENT, and those of files.
absl::StatusOr<TriangleMesh> MeshNamed(const std::string& name);

// Divides each triangle into four at the midpoints of its edges, `times` times. Vertices stay shared.
TriangleMesh Subdivided(TriangleMesh mesh, int times);

// The mesh and count - 1 copies of it, each moved along x by half of the mesh's length there. Copies overlap.
TriangleMesh Copied(TriangleMesh mesh, uint32_t count);

}  // namespace latvox

#endif  // LATVOX_TESTS_BENCH_MESHES_H_
