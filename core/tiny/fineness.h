// How fine a mesh is, which decides how its voxels are best found.
#ifndef LATVOX_CORE_TINY_FINENESS_H_
#define LATVOX_CORE_TINY_FINENESS_H_

#include <vector>

#include "core/digitize/principal_scan.h"
#include "core/snap/snap.h"

namespace latvox {

// Both are hints: whatever they say, the voxels are the same.
struct Fineness {
  bool few_touch = false;  // leaving out triangles that no lattice line can meet pays: core/tiny/touching.h
  bool most_tiny = false;  // so does doing the tiny ones by themselves: core/tiny/tiny.h
};

// By a sample of triangles spread over the mesh. Meshes of few triangles are not fine.
Fineness FinenessOf(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames);

}  // namespace latvox

#endif  // LATVOX_CORE_TINY_FINENESS_H_
