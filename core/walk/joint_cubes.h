// Which of many walks may hold points of their sets in a tile, without a look at each walk.
#ifndef LATVOX_CORE_WALK_JOINT_CUBES_H_
#define LATVOX_CORE_WALK_JOINT_CUBES_H_

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "core/base/vec.h"

namespace latvox {

// An index of the cubes of tiles that walks hold points in. Tiles count as cubes of kLeastLevel, for the sake of
// memory. Reading it is safe from any thread.
class JointCubes {
 public:
  static constexpr int kLeastLevel = 1;

  //   first_tile, level   the cube of all tiles: its lowest, and log2 of its side
  JointCubes(const Vec3i& first_tile, int level) : first_tile_(first_tile), level_(std::max(level, kLeastLevel)) {}

  // Adds a tile, or a cube of 2^level tiles a side. Ranks come in ascending order.
  void Add(uint32_t rank, const Vec3i& tile_ijk, int level);

  // Returns whether a walk may hold points in a cube of tiles. Precondition: level >= kLeastLevel.
  bool MayHold(const Vec3i& tile_ijk, int level) const;

  // Returns whether f(rank) holds for a walk that may hold points in a tile.
  template <class F>
  bool AnyAt(const Vec3i& tile_ijk, const F& f) const {
    for (int level = level_; level >= kLeastLevel; --level) {
      const auto found = chains_.find(KeyOf(tile_ijk, level));
      if (found == chains_.end()) return false;  // smaller cubes in it would have added it
      for (uint32_t n = found->second.first; n != kNone; n = links_[n].next) {
        if (f(links_[n].rank)) return true;
      }
    }
    return false;
  }

 private:
  static constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

  // The walks of a cube, ascending. It has none if they hold points in smaller cubes only.
  struct Chain {
    uint32_t first = kNone, last = kNone;
  };
  struct Link {
    uint32_t rank, next;
  };

  uint64_t KeyOf(const Vec3i& tile_ijk, int level) const;

  Vec3i first_tile_;
  int level_;
  absl::flat_hash_map<uint64_t, Chain> chains_;  // with a cube, all larger ones around it
  std::vector<Link> links_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_WALK_JOINT_CUBES_H_
