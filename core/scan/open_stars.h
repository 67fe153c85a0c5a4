// The stars (stars.h) that may have a link to a voxel outside of a set.
#ifndef LATVOX_CORE_SCAN_OPEN_STARS_H_
#define LATVOX_CORE_SCAN_OPEN_STARS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/digitize/principal_scan.h"
#include "core/scan/candidates.h"
#include "core/snap/snap.h"
#include "core/tile/tile_bits.h"
#include "core/tile/voxel_triangle.h"

namespace latvox {

// The rows of a layout that hold a voxel's neighbors along the frames, and the voxel itself.
struct NeighborRows {
  static constexpr size_t kMost = 2 * kMaxPairs + 1;

  struct Place {
    size_t row;
    uint32_t bit;
  };

  NeighborRows(const std::vector<ScanFrame>& frames, const BitsLayout& layout);

  size_t count = 0;
  int32_t reach = 0;                        // the largest |entry| of q
  int32_t reach_in_row = 0;                 // the largest |q[2]|; bit n of a row is the voxel at n - reach_in_row
  std::array<int32_t, kMost> byte_steps{};  // from the voxel's own row
  int32_t least_step = 0;                   // of these
  Place itself{};
  std::array<Place, kMaxDirections> forward{}, backward{};  // the neighbors along +q and -q, for each frame

 private:
  Place Add(const BitsLayout& layout, const Vec3i& step);
};

// Appends the pairs of candidates and triangles of a run whose stars may have a link with an end outside of `set`, and
// few others. Plain C++ appends all pairs.
//   run   in candidates.runs
// Precondition: the candidates lie in the layout with all of their neighbors.
void AppendOpenStars(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames, const BitsLayout& layout,
                     const NeighborRows& rows, const TileBits& set, const Candidates& candidates, size_t run,
                     std::vector<VoxelTriangle>& pairs);

}  // namespace latvox

#endif  // LATVOX_CORE_SCAN_OPEN_STARS_H_
