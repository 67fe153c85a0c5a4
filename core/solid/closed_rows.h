// The points of a tile inside of triangles with a sum that does not depend on the path.
#ifndef LATVOX_CORE_SOLID_CLOSED_ROWS_H_
#define LATVOX_CORE_SOLID_CLOSED_ROWS_H_

#include <array>
#include <cstdint>
#include <span>

#include "core/base/stop_signal.h"
#include "core/base/vec.h"
#include "core/brick/brick.h"
#include "core/request/solid.h"
#include "core/snap/snap.h"
#include "core/solid/interior.h"

namespace latvox {

class ClosedRows {
 public:
  // Finds the points of the tile with this lowest point, local. Once stopped, they are meaningless, and the memory of
  // `rows` must not be used again.
  //   at_corner   the sum at the lowest point
  //   triangles   as for Interior::Find
  static void Find(const SnappedMesh& mesh, InteriorRule rule, const Vec3i& low, int32_t at_corner,
                   std::span<const uint32_t> triangles, StopSignal stop, InteriorRows& rows);

 private:
  static void AddToRow(InteriorRule rule, size_t row, int32_t k, int32_t turn, InteriorRows& rows);
  static void FinishStarts(const std::array<int32_t, kTileSide>& along_i, InteriorRows& rows);
  static void FinishRows(InteriorRule rule, InteriorRows& rows);
  static uint64_t SumRow(InteriorRule rule, uint64_t changes, int32_t sum, int32_t* turns);
};

}  // namespace latvox

#endif  // LATVOX_CORE_SOLID_CLOSED_ROWS_H_
