// Which lattice points of a tile are inside of a mesh.
//
// Closed meshes: the sum of signed crossings does not depend on the path. One lattice point of each tile is told from
// the lines along k through the tiles' corners, which are one in 64^2; from there, within the tile and by its own
// triangles, the path goes along i, then along j, then along k. So tiles without triangles cost nothing, and memory is
// that of the corner lines through the region.
//
// Meshes that are not closed: the path is the line along k, from below, on lines that are balanced; the others hold no
// interior points. All crossings of all lines along k through the region are kept.
#ifndef LATVOX_CORE_SOLID_INTERIOR_H_
#define LATVOX_CORE_SOLID_INTERIOR_H_

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/bytes_of.h"
#include "core/base/stop_signal.h"
#include "core/brick/brick.h"
#include "core/request/solid.h"
#include "core/snap/snap.h"

namespace latvox {

// The points of one tile: bit k of row (i << 6 | j). Also what finding them takes, from tile to tile.
class InteriorRows {
 public:
  InteriorRows() : rows_(kRows), starts_(kRows) {}

  std::span<const uint64_t> view() const { return rows_; }
  size_t Bytes() const { return BytesOf(rows_) + BytesOf(starts_) + BytesOf(turns_); }

 private:
  friend class ClosedInterior;
  friend class OpenInterior;
  static constexpr size_t kRows = size_t{kTileSide} * kTileSide;

  std::vector<uint64_t> rows_;
  std::vector<int32_t> starts_;  // sums at k = 0
  std::vector<int32_t> turns_;   // kWinding: what each point adds to its row's sum; otherwise all 0
};

class Interior {
 public:
  virtual ~Interior() = default;

  // Whether a cube of 2^level tiles a side that no triangle meets may have points of the region inside; tile_ijk: its
  // lowest, local.
  virtual bool MayHold(const Vec3i& tile_ijk, int level) const = 0;

  // Finds the points of a tile (local) that meets the region; of others outside of it, nothing is said.
  //   triangles   all that meet the box around its lattice points; more do no harm
  virtual void Find(const Vec3i& tile_ijk, std::span<const uint32_t> triangles, InteriorRows& rows) const = 0;
};

// Both keep a reference to the mesh, and the signal. What they make, and what is found, means nothing once they are
// cancelled.
//   region   local voxels: others are not asked for
//
// Precondition: the mesh is closed (kParity) or oriented (kWinding).
std::unique_ptr<Interior> MakeClosedInterior(const SnappedMesh& mesh, InteriorRule rule, const IndexBox& region,
                                             StopSignal stop = {});
// Of any mesh. Memory: kBytesPerLineCrossing for each crossing of a line along k.
std::unique_ptr<Interior> MakeOpenInterior(const SnappedMesh& mesh, InteriorRule rule, const IndexBox& region,
                                           StopSignal stop = {});

// Twice, as arrays grow, and once more, while they are gathered.
inline constexpr uint64_t kBytesPerLineCrossing = 24;

}  // namespace latvox

#endif  // LATVOX_CORE_SOLID_INTERIOR_H_
