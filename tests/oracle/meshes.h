// Meshes that provoke errors. They have lattice points on vertices and edges, depths exactly halfway, slivers,
// duplicates and zero areas. Others are sheets closer than a voxel, nested and inverted shells, or triangles much
// larger or smaller than a voxel.
#ifndef LATVOX_TESTS_ORACLE_MESHES_H_
#define LATVOX_TESTS_ORACLE_MESHES_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/oracle/oracle.h"

namespace latvox::oracle {

struct NamedMesh {
  std::string name;        // unique, "family/variant"
  Mesh triangles;          // lattice coordinates in units of 1/256 voxel, some negative
  bool closed;             // every line of every bundle crosses it an even number of times
  std::optional<Box> box;  // where to look, for meshes far larger than that; none: everywhere
};

// All families. Meshes without a box span at most about 12 voxels on each axis. Deterministic: a function of the seed
// and the directions alone, on every platform. Directions are the lattice's, as in oracle.h: they place edges along
// them.
std::vector<NamedMesh> AdversarialMeshes(uint64_t seed, const std::vector<Int3>& directions);

// Returns a quad (two triangles) in the plane { x : normal . x = offset } (mesh units). Its center is the plane's point
// nearest the origin along one axis. It reaches `half_width` mesh units each way along the two axes that span it.
// Requires a normal with a component ±1.
Mesh PlaneQuad(const Int3& normal, int64_t offset, int64_t half_width);

}  // namespace latvox::oracle

#endif  // LATVOX_TESTS_ORACLE_MESHES_H_
