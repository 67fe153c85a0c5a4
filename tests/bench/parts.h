// Meshes of parts that are designed, not scanned: large flat or curved faces, sharp edges, thin walls.
#ifndef LATVOX_TESTS_BENCH_PARTS_H_
#define LATVOX_TESTS_BENCH_PARTS_H_

#include <optional>
#include <string_view>

#include "core/mesh/mesh.h"

namespace latvox {

// Returns the mesh of a name, which is the same each time. Voxels below are those at 256.
//   gears      four gears with bores, each turned its own way
//   plates     four perforated plates without outer walls, 1.5 voxels thick; two of them lie along lattice planes
//   honeycomb  hexagonal cells along z without outer walls; the walls are 2 voxels thick
//   threads    nine bolts with screw threads
//   pipes      60 pipes along the axes, with walls of 1 to 3 voxels
//   city       1,000 boxes on a plane
//   shells     six hollow spheres with walls of 1 to 3 voxels
//   tree       1,023 branches, 0.7 to 9 voxels thick
std::optional<TriangleMesh> PartsNamed(std::string_view name);

}  // namespace latvox

#endif  // LATVOX_TESTS_BENCH_PARTS_H_
