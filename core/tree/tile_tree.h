// The triangles that concern each tile: an octree over tiles, walked depth first, and never held as a whole.
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

// Returns log2 of the side, in tiles, of the cube that begins at the lowest tile of the box and contains the box.
int TileCubeLevel(const IndexBox& box);

// A cube of 2^level tiles a side, with the triangles near to it.
struct TileNode {
  Vec3i tile_ijk;  // its lowest tile, local
  int level;
  std::vector<uint32_t> triangles;  // triangles that come within the tree's near margin of the node, ascending
  std::vector<uint32_t> fringe;     // further triangles that come within its far margin, ascending
  double progress;                  // estimated share of the work before this node
  double share;                     // estimated share of its own work
  size_t links = 0;                 // the tree's links with their nearer end in it
};

// Walked depth first, in the order of children (Morton, i most significant), tiles come in Morton order: the canonical
// order of the stream. Children lie several levels below their node, so that few passes over the triangles lead to the
// tiles. The memory is that of one path: each node on it has its siblings' triangles beside it.
//
// No tile misses a triangle that concerns it. A child's margins lie within its parent's, and a triangle is dropped only
// where its box, or a separating axis, shows that it misses the margins of the child. More triangles do no harm.
//
// Threads: any; all threads of the arena sort nodes with many triangles.
class TileTree {
 public:
  // leaf_level  log2 of the side of the smallest nodes in tiles
  // near, far   margins around a tile, voxels per axis, within which triangles concern it; near <= far
  // region      tiles outside (local voxels) are left out
  // stop        once stopped, calls return soon, with nothing
  TileTree(const SnappedMesh& mesh, int leaf_level, const Vec3i& near, const Vec3i& far, const IndexBox& region,
           StopSignal stop)
      : mesh_(mesh), leaf_level_(leaf_level), near_(near), far_(far), region_(region), stop_(stop), vertices_(mesh) {}

  void SetLeafLevel(int level) { leaf_level_ = level; }

  // Also makes children of nodes with these links, from now on, where they meet the region. Kept by reference.
  void AddLinks(const TileLinks& links) { links_ = &links; }

  // Also makes children of nodes without triangles nearby, from now on, where they meet the region.
  void KeepEmpty() { keep_empty_ = true; }

  int level() const { return TileCubeLevel(mesh_.box); }

  // Returns whether the node is one of the smallest, or one of its tiles.
  bool IsLeaf(const TileNode& node) const { return node.level <= leaf_level_; }

  // Returns the children of the cube of all tiles, or that cube if it is a leaf.
  //   triangles  ascending: only these count; nullopt: all of the mesh
  std::vector<TileNode> Top(std::optional<std::vector<uint32_t>> triangles = std::nullopt) const;

  // Returns the children with triangles within their near margin, or with links, in canonical order. The children of a
  // leaf are its tiles. Precondition: node.level > 0.
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
