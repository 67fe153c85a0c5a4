// The lattice points of a tile inside of a mesh.
//
// Closed meshes: the sum of signed crossings does not depend on the path. The lines along k through the tiles' corners,
// one in 64^2, decide on one lattice point of each tile. From there, within the tile and by its own triangles, the path
// goes along i, then along j, then along k. So tiles without triangles cost nothing, and the memory is that of the
// corner lines through the region.
//
// Meshes that are not closed: the path is the line along k, from below, on lines that are balanced. Other lines have no
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
#include "core/brick/filled_tiles.h"
#include "core/brick/label_runs.h"
#include "core/request/solid.h"
#include "core/snap/snap.h"
#include "core/solid/label_sweep.h"

namespace latvox {

// The points of one tile: bit k of row (i << 6 | j). Also the memory for their search, from tile to tile.
class InteriorRows {
 public:
  InteriorRows() : rows_(kRows), starts_(kRows) {}

  std::span<const uint64_t> view() const { return rows_; }
  // For a labeled solid: the labels of the same points. The caller may take them.
  LabelRuns& labels() { return labels_; }
  size_t Bytes() const {
    return BytesOf(rows_) + BytesOf(starts_) + BytesOf(turns_) + BytesOf(labels_.starts) + BytesOf(labels_.runs) +
           BytesOf(of_points_) + sweep_.Bytes();
  }

 private:
  friend class ClosedRows;
  friend class OpenInterior;
  friend class ClosedLabeledInterior;
  friend class OpenLabeledInterior;
  static constexpr size_t kRows = size_t{kTileSide} * kTileSide;

  std::vector<uint64_t> rows_;
  std::vector<int32_t> starts_;  // sums at k = 0
  std::vector<int32_t> turns_;   // unless kParity: the change of its row's sum at each point; otherwise all 0
  LabelRuns labels_;
  LabelSweep sweep_;
  std::vector<uint32_t> of_points_;  // for many labels in a tile: the label of each point, row by row
};

class Interior : public FilledTiles {
 public:
  // Finds the points of a tile (local) that meets the region. Rows for points outside of the region are meaningless.
  //   triangles   all that cross a line along an axis, between its lattice points; more do no harm
  virtual void Find(const Vec3i& tile_ijk, std::span<const uint32_t> triangles, InteriorRows& rows) const = 0;
};

// Both keep a reference to the mesh, and the signal. Once cancelled, results are meaningless.
//   region   local voxels: others are not needed
//
// Precondition: the mesh is closed (kParity) or oriented (other rules). The rule is not kAuto.
std::unique_ptr<Interior> MakeClosedInterior(const SnappedMesh& mesh, InteriorRule rule, const IndexBox& region,
                                             StopSignal stop = {});
// For any mesh. Memory: kBytesPerLineCrossing for each crossing of a line along k.
std::unique_ptr<Interior> MakeOpenInterior(const SnappedMesh& mesh, InteriorRule rule, const IndexBox& region,
                                           StopSignal stop = {});

// Twice, because arrays grow, and once more, while they are gathered.
inline constexpr uint64_t kBytesPerLineCrossing = 24;

}  // namespace latvox

#endif  // LATVOX_CORE_SOLID_INTERIOR_H_
