// The fields of links of a job's tiles.
#ifndef LATVOX_CORE_BLOCK_LINK_TILES_H_
#define LATVOX_CORE_BLOCK_LINK_TILES_H_

#include <cstddef>
#include <span>

#include "core/block/link_scan.h"
#include "core/block/scan_pool.h"
#include "core/block/tile_context.h"
#include "core/brick/brick.h"
#include "core/fields/link_order.h"
#include "core/fields/link_table.h"
#include "core/request/fields.h"
#include "core/tree/tile_tree.h"

namespace latvox {

// Threads: Add, any thread.
class LinkTiles {
 public:
  //   context   its reach is that of the frames
  //   fields    of the request; empty: the job has none
  LinkTiles(const TileContext& context, const FieldList& fields)
      : context_(context), fields_(fields), order_(context.frames) {}

  // Finds the fields of links of the tiles, which lie in the node. They are incomplete once the job is stopped.
  //   node   its triangles are all that come within a step of it; more do no harm
  void Add(const TileNode& node, std::span<TileBricks> tiles) const;

 private:
  struct Scan {
    LinkScan links;
    LinkTable table;
    size_t Bytes() const { return links.Bytes() + table.Bytes(); }
  };

  void AddStar(const LinkTable& table, const BlockBox& where, const VoxelTriangle& pair, const StarLinks& star) const;

  const TileContext context_;
  const FieldList fields_;
  const LinkOrder order_;
  mutable ScanPool<Scan> scans_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_BLOCK_LINK_TILES_H_
