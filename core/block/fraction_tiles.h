// The fractions of a job's tiles.
#ifndef LATVOX_CORE_BLOCK_FRACTION_TILES_H_
#define LATVOX_CORE_BLOCK_FRACTION_TILES_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/bytes_of.h"
#include "core/base/stop_signal.h"
#include "core/block/scan_pool.h"
#include "core/brick/brick.h"
#include "core/brick/label_rows.h"
#include "core/fields/fraction_table.h"
#include "core/fields/plan.h"
#include "core/snap/finer_mesh.h"
#include "core/snap/snap.h"
#include "core/solid/interior.h"
#include "core/tree/tile_tree.h"

namespace latvox {

// Returns how far, per axis in voxels, a cell reaches from its voxel, rounded up.
Vec3i ReachOf(const CellPoints& cell);

// Returns the finer points, local, of the cells of a region of voxels.
IndexBox FinerPointsOf(const CellPoints& cell, const FinerMesh& finer, const IndexBox& region);

// Threads: Add, any thread.
class FractionTiles {
 public:
  //   plan     null, or without a cell: the job has no fractions
  //   finer    null if so
  //   labels   those of Field::kLabelFractions
  // All must outlive it.
  FractionTiles(const SnappedMesh& mesh, const FieldPlan* plan, const FinerMesh* finer,
                std::span<const uint32_t> labels, StopSignal stop);

  // Finds the fractions of the tiles. They are incomplete once the job is stopped.
  //   triangles   all that meet the tiles with a margin of ReachOf; more do no harm
  //   interior    of the mesh; `finer` is that of the finer mesh, for all points of cells
  void Add(std::span<const uint32_t> triangles, const Interior* interior, const Interior* finer,
           std::span<TileBricks> tiles) const;

 private:
  // The fractions of all labels together, or of one of them.
  struct Column {
    size_t place;                 // of the field among those of the request
    std::optional<size_t> label;  // its place in labels_, and among the numbers of a voxel
  };
  // Points of a tile that are inside, and for each label those that it contains.
  struct Points {
    InteriorRows all;
    LabelRows of_labels;
    std::span<const uint64_t> Of(const Column& column) const {
      return column.label ? of_labels.Of(*column.label) : all.view();
    }
    // Whether any may be in the column.
    bool Has(const Column& column) const { return !column.label || of_labels.Has(*column.label); }
  };
  struct Scan {
    Points voxels, finer;
    std::vector<FractionTable> tables;  // of columns_
    std::vector<uint32_t> triangles;    // of a finer tile
    size_t Bytes() const;
  };

  void Find(const Interior& interior, const Vec3i& tile_ijk, std::span<const uint32_t> triangles, Points& points) const;
  void AddNode(const TileTree& tree, const TileNode& node, const Interior& finer, Scan& scan) const;

  const SnappedMesh& mesh_;
  const FieldPlan* const plan_;
  const FinerMesh* const finer_;
  const std::span<const uint32_t> labels_;
  std::vector<Column> columns_;
  const StopSignal stop_;
  mutable ScanPool<Scan> scans_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_FRACTION_TILES_H_
