// Meshes of simple shapes that are hard in one way each.
#ifndef LATVOX_TESTS_BENCH_SHAPES_H_
#define LATVOX_TESTS_BENCH_SHAPES_H_

#include <cstdint>

#include "core/mesh/mesh.h"

namespace latvox {

// A unit square along lattice planes, of two triangles. A cylinder of 64 sides, 1/32 wide and high, stands in its
// middle.
TriangleMesh Ground();

// `count` closed regular tetrahedra, scattered over a unit cube. Their edges are as long as a voxel at 256. The same
// number gives the same mesh.
TriangleMesh Forest(uint32_t count);

// `count` triangles, each with three random corners in a unit cube, so that they cross each other everywhere. The same
// number gives the same mesh.
TriangleMesh Tangle(uint32_t count);

// A disk of `count` triangles around its center, which is a vertex of all.
TriangleMesh Fan(uint32_t count);

// A closed cylinder, as high as wide. Each of its sides is two triangles of full height; its ends are fans.
TriangleMesh Cylinder(uint32_t sides);

}  // namespace latvox

#endif  // LATVOX_TESTS_BENCH_SHAPES_H_
