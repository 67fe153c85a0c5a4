// Decides how fine a mesh is, and so which way to find its voxels.
#ifndef LATVOX_CORE_TINY_FINENESS_H_
#define LATVOX_CORE_TINY_FINENESS_H_

#include <vector>

#include "core/digitize/principal_scan.h"
#include "core/snap/snap.h"

namespace latvox {

// Both are hints. The voxels are the same in any case.
struct Fineness {
  bool few_touch = false;  // it pays to leave out triangles that no lattice line can meet: core/tiny/touching.h
  bool most_tiny = false;  // it pays to treat tiny triangles separately: core/tiny/tiny.h
};

// Judges by a sample of triangles spread over the mesh. Meshes with few triangles are not fine.
Fineness FinenessOf(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames);

// Does the same for a supercover where cells are boxes: returns whether it pays to treat tiny triangles separately, in
// core/tiny/tiny_cover.h.
bool IsFineForCover(const SnappedMesh& mesh);

}  // namespace latvox

#endif  // LATVOX_CORE_TINY_FINENESS_H_
