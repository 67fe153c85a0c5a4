// The pieces of all tiles, the cubes between them and the outside, united where a walk leads from one to the other.
#ifndef LATVOX_CORE_WALK_GRAPH_H_
#define LATVOX_CORE_WALK_GRAPH_H_

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "core/base/vec.h"
#include "core/brick/brick.h"
#include "core/walk/tile_pieces.h"

namespace latvox {

// Which nodes the walks reach. Reading it is safe from any thread.
class WalkGraph {
 public:
  static constexpr uint32_t kOutside = 0;  // the node of all points outside of the mesh's box

  //   first_tile, level   the cube of all tiles: its lowest, and log2 of its side
  WalkGraph(const Vec3i& first_tile, int level, const IndexBox& mesh_box);

  // Adds a tile or a cube of tiles without walls. Any thread, in any order.
  void AddTile(const Vec3i& tile_ijk, TilePieces pieces);
  void AddCube(const Vec3i& tile_ijk, int level);

  // Unites nodes, and drops what only that needs. Call it once, after all tiles. Which nodes are connected
  // is a function of the tiles; the numbers of cubes' nodes are not.
  void Unite();

  // The nodes of a tile's pieces: consecutive numbers.
  struct TileNodes {
    uint32_t first, count;
  };
  // Null: no such tile was added.
  const TileNodes* FindTile(const Vec3i& tile_ijk) const;
  // The node of the cube with this cube in it; nullopt: there is none.
  std::optional<uint32_t> FindCube(const Vec3i& tile_ijk, int level) const;
  // Calls f(tile_ijk) for each tile, and f(tile_ijk, level, node) for each cube, in any order.
  template <class F>
  void ForEachTile(const F& f) const {
    for (const auto& [tile_ijk, nodes] : tiles_) f(tile_ijk);
  }
  template <class F>
  void ForEachCube(const F& f) const {
    for (size_t level = 0; level < cubes_.size(); ++level) {
      for (const auto& [tile_ijk, node] : cubes_[level]) f(tile_ijk, static_cast<int>(level), node);
    }
  }
  // Whether the tile lies in the cube of all tiles.
  bool Contains(const Vec3i& tile_ijk) const;

  bool IsConnected(uint32_t a, uint32_t b) const { return roots_[a] == roots_[b]; }

  // The numbers of points of all connected sets, except the outside, descending.
  std::vector<uint64_t> Volumes() const;

 private:
  struct Tile {
    Vec3i tile_ijk;
    TilePieces pieces;
  };
  uint32_t Root(uint32_t node);
  void Join(uint32_t a, uint32_t b);
  void UniteTile(size_t n);
  void UniteCube(const Vec3i& tile_ijk, int level, uint32_t node);

  const Vec3i first_tile_;
  const int level_;
  const IndexBox mesh_box_;
  std::mutex mutex_;
  std::vector<Tile> new_tiles_;  // until Unite
  absl::flat_hash_map<Vec3i, TileNodes> tiles_;
  std::vector<absl::flat_hash_map<Vec3i, uint32_t>> cubes_;  // by level
  std::vector<uint32_t> roots_;                              // by node
  std::vector<uint64_t> points_;                             // by node
};

}  // namespace latvox

#endif  // LATVOX_CORE_WALK_GRAPH_H_
