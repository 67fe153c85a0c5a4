// The lattice points inside of a closed mesh: a line from such a point to the outside crosses the mesh an odd number of
// times.
//
// Two neighbors along a lattice line differ in this iff the mesh crosses the link between them an odd number of times,
// by the crossing rule (core/digitize/crossing.h). The rule breaks ties by one shift of the whole surface. So one point
// of a tile and the triangles around the tile decide on all of its points.
#ifndef LATVOX_CORE_BAND_INSIDE_H_
#define LATVOX_CORE_BAND_INSIDE_H_

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "core/base/stop_signal.h"
#include "core/lattice/frame.h"
#include "core/snap/snap.h"

namespace latvox {

// The crossings of the mesh with the lattice lines along k through the low corners of tiles. Memory: some 12 bytes for
// each crossing; a surface has one for every 4096 voxels.
class CornerLines {
 public:
  // Once stopped, returns early with a meaningless result.
  CornerLines(const SnappedMesh& mesh, StopSignal stop);

  // Whether a tile's low corner lies inside; tile_min is local.
  bool IsInside(const Vec3i& tile_min) const;

 private:
  // By (i, j): the k before each crossing, ascending.
  absl::flat_hash_map<std::pair<int32_t, int32_t>, std::vector<int32_t>> crossings_;
};

// One bit for each lattice point of a tile: bit k of word (i << 6 | j).
using TileMask = std::array<uint64_t, size_t{kTileSide} * kTileSide>;

// Sets the bits of the points inside.
//   corner_inside   whether the tile's low corner is inside
//   triangles       all that meet the tile; more do no harm
void FindInside(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const Vec3i& tile_min, bool corner_inside,
                StopSignal stop, TileMask& inside);

}  // namespace latvox

#endif  // LATVOX_CORE_BAND_INSIDE_H_
