// Which triangles concern which tile: an octree over tiles, walked depth first, that is never held as a whole.
#ifndef LATVOX_CORE_TILE_TILE_TREE_H_
#define LATVOX_CORE_TILE_TILE_TREE_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "core/snap/snap.h"
#include "core/tile/brick.h"

namespace latvox {

// A cube of 2^level tiles a side, with the triangles that come within the tree's margin of it.
struct TileNode {
  Vec3i tile_ijk;  // lowest tile, local; a multiple of 2^level
  int level;
  std::vector<uint32_t> triangles;  // ascending
  double progress;                  // estimated share of the work before this node,
  double share;                     // and of its own
};

// Depth first and in ascending child order (i most significant), nodes come in Morton order of tiles: the canonical
// order of the stream. Memory is that of one path: each level holds its siblings' triangles.
class TileTree {
 public:
  // margin: voxels, per axis, by which a tile's interest exceeds it. region: tiles outside (local voxels) are left out.
  TileTree(const SnappedMesh& mesh, const Vec3i& margin, const IndexBox& region)
      : mesh_(mesh), margin_(margin), region_(region) {}

  // The cube of all tiles, or nullopt if there is none of interest.
  std::optional<TileNode> Root() const;

  // The children that triangles concern, in canonical order. Precondition: node.level > 0.
  std::vector<TileNode> Children(const TileNode& node) const;

 private:
  bool IsWanted(const TileNode& node) const;

  const SnappedMesh& mesh_;
  Vec3i margin_;
  IndexBox region_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_TILE_TILE_TREE_H_
