// Which lattice points lie inside of a closed mesh: those from which a line to the outside crosses it an odd number of
// times.
//
// Two neighbours along a lattice line differ in this iff the mesh crosses the link between them an odd number of times,
// by the crossing rule (core/digitize/crossing.h), whose ties are those of one shift of the whole surface. So one point
// of a tile and the triangles around the tile tell all of it.
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

// Where the mesh crosses the lattice lines along k through the low corners of tiles. Memory: 12 bytes or so for each
// such crossing, of which a surface has one in 4096 voxels.
class CornerLines {
 public:
  // Returns early, without meaning, once cancelled.
  CornerLines(const SnappedMesh& mesh, StopSignal stop);

  // Whether a tile's low corner lies inside; tile_min is local.
  bool IsInside(const Vec3i& tile_min) const;

 private:
  // By (i, j): the k after which each crossing comes, ascending.
  absl::flat_hash_map<std::pair<int32_t, int32_t>, std::vector<int32_t>> crossings_;
};

// One bit for each lattice point of a tile: bit k of word (i << 6 | j).
using TileMask = std::array<uint64_t, size_t{kTileSide} * kTileSide>;

// Sets the bits of those inside.
//   corner_inside   whether the tile's low corner is
//   triangles       all that meet the tile; more do no harm
void FindInside(const SnappedMesh& mesh, std::span<const uint32_t> triangles, const Vec3i& tile_min, bool corner_inside,
                StopSignal stop, TileMask& inside);

}  // namespace latvox

#endif  // LATVOX_CORE_BAND_INSIDE_H_
