// Leaves out the triangles that cross no lattice line along an axis: most, if they are smaller than voxels.
#ifndef LATVOX_CORE_SOLID_CROSSING_TRIANGLES_H_
#define LATVOX_CORE_SOLID_CROSSING_TRIANGLES_H_

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/stop_signal.h"
#include "core/snap/snap.h"

namespace latvox {

// Finds those of some triangles whose bounding boxes meet a line, in their order. A box meets a line along an axis if
// it holds integers on both other axes. Once stopped, some are missing.
void FindCrossing(const SnappedMesh& mesh, std::span<const uint32_t> triangles, StopSignal stop,
                  std::vector<uint32_t>& crossing);

}  // namespace latvox

#endif  // LATVOX_CORE_SOLID_CROSSING_TRIANGLES_H_
