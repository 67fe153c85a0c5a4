// Which triangles any lattice edge can meet at all.
#ifndef LATVOX_CORE_DIGITIZE_TOUCHING_H_
#define LATVOX_CORE_DIGITIZE_TOUCHING_H_

#include <cstdint>
#include <span>
#include <vector>

#include "core/digitize/principal_scan.h"
#include "core/snap/snap.h"

namespace latvox {

// Appends those of `triangles` that a lattice line along some direction may meet, in their order; the others cross no
// lattice edge and contribute nothing.
//
// A line along q is a point (a, b) of the projection along q (core/lattice/frame.h). It can only meet a triangle whose
// corners lie on both sides of a, and on both sides of b. Rows of frames are few linear forms, shared by many frames:
// the floors of a form at the corners differ, or no line lies between them. That holds with the shift of
// core/digitize/crossing.h, too, which moves a form with a first nonzero entry above 0 up; forms are turned so.
void FindTouching(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const std::vector<ScanFrame>& frames,
                  std::vector<uint32_t>& touching);

}  // namespace latvox

#endif  // LATVOX_CORE_DIGITIZE_TOUCHING_H_
