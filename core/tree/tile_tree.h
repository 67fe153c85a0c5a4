// Which triangles concern which tile: an octree over tiles, walked depth first, that is never held as a whole.
#ifndef LATVOX_CORE_TREE_TILE_TREE_H_
#define LATVOX_CORE_TREE_TILE_TREE_H_

#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/base/stop_signal.h"
#include "core/brick/brick.h"
#include "core/snap/snap.h"
#include "core/tile/tile_links.h"
#include "core/tree/octant_grid.h"
#include "core/triangles/padded_vertices.h"

namespace latvox {

// Log2 of the side, in tiles, of the cube that begins at the lowest tile of the box and holds them all.
int TileCubeLevel(const IndexBox& box);

// A cube of 2^level tiles a side, with the triangles near to it.
struct TileNode {
  Vec3i tile_ijk;  // its lowest tile, local
  int level;
  std::vector<uint32_t> triangles;  // those that come within the tree's near margin of it, ascending
  std::vector<uint32_t> fringe;     // the others that come within its far margin, ascending
  double progress;                  // estimated share of the work before this node,
  double share;                     // and of its own
  size_t links = 0;                 // how many of the tree's links have their nearer end in it
};

// Depth first and in the order of children (Morton, i most significant), tiles come in Morton order: the canonical
// order of the stream. Children lie several levels below their node, so that few passes over the triangles lead to the
// tiles. Memory is that of one path: each node on it has its siblings' triangles beside it.
//
// Threads: any; nodes with many triangles are sorted by all of the arena's.
class TileTree {
 public:
  // leaf_level  log2 of the side of the smallest nodes in tiles
  // near, far   margins, voxels per axis, by which a tile's interest exceeds it, near <= far
  // region      tiles outside (local voxels) are left out
  // stop        once stopped, calls return soon, with nothing
  TileTree(const SnappedMesh& mesh, int leaf_level, const Vec3i& near, const Vec3i& far, const IndexBox& region,
           StopSignal stop)
      : mesh_(mesh), leaf_level_(leaf_level), near_(near), far_(far), region_(region), stop_(stop), vertices_(mesh) {}

  void SetLeafLevel(int level) { leaf_level_ = level; }

  // From now on nodes with these links count as children, too, where they meet the region. Kept by reference.
  void AddLinks(const TileLinks& links) { links_ = &links; }

  // From now on nodes that no triangle comes near to count as children, too, where they meet the region.
  void KeepEmpty() { keep_empty_ = true; }

  int level() const { return TileCubeLevel(mesh_.box); }

  // Whether the node is of the smallest, or one of its tiles.
  bool IsLeaf(const TileNode& node) const { return node.level <= leaf_level_; }

  // The children of the cube of all tiles, or that cube if it is a leaf.
  //   triangles  ascending: only these count; nullopt: all of the mesh
  std::vector<TileNode> Top(std::optional<std::vector<uint32_t>> triangles = std::nullopt) const;

  // The children within the near margin of which triangles come, or with links, in canonical order; those of a leaf are
  // its tiles. Precondition: node.level > 0.
  std::vector<TileNode> Children(const TileNode& node) const;

 private:
  struct Chunk;
  class HitCounts;

  size_t LinksIn(const Vec3i& tile_ijk, int level) const;
  std::vector<TileNode> Split(const TileNode& node, size_t triangles, int leaf_level) const;
  std::optional<std::vector<TileNode>> SplitBy(int levels, const TileNode& node, size_t triangles,
                                               size_t max_hits) const;
  static void SetTriangles(const TileNode& node, size_t begin, size_t end, Chunk& chunk);
  void FindHits(const OctantGrid& grid, size_t max_hits, std::atomic<size_t>& total, Chunk& chunk) const;
  static void AddCounts(size_t first, size_t last, std::vector<Chunk>& chunks, std::vector<uint32_t>& sums);
  static void Fill(uint32_t* const* lists, Chunk& chunk);

  bool MeetsRegion(const Vec3i& tile_ijk, int level) const;

  const SnappedMesh& mesh_;
  const TileLinks* links_ = nullptr;
  int leaf_level_;
  bool keep_empty_ = false;
  Vec3i near_, far_;
  IndexBox region_;
  StopSignal stop_;
  PaddedVertices vertices_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_TREE_TILE_TREE_H_
