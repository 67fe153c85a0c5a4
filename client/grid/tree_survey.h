// What the first bytes of a file depend on. Internal to latvox::grid and the tool.
#ifndef LATVOX_CLIENT_GRID_TREE_SURVEY_H_
#define LATVOX_CLIENT_GRID_TREE_SURVEY_H_

#include <cstdint>
#include <limits>
#include <map>

#include "client/grid/brick_tree.h"
#include "client/grid/metadata.h"

namespace latvox::client {

struct VoxelCounts {
  uint64_t voxels = 0, bricks = 0;
};

// An upper node. Full lower nodes are tiles.
struct UpperShape {
  uint32_t first;  // the lowest number of its lower nodes
  UpperMask children{}, tiles{};
  uint32_t full = 0;  // tiles

  bool is_full() const { return full == kLowersOfUpper; }  // then it is a tile
};

// The facts about a tree, pruned. Memory: 8 KB for each upper node. A mesh may be 131,072 voxels long on each axis, so
// there are at most 33^3 of them: 300 MB.
class TreeSurvey {
 public:
  // Goes through all nodes once.
  explicit TreeSurvey(LowerNodes& nodes);

  const std::map<Vec3i, UpperShape>& uppers() const { return uppers_; }  // by low corner, in the tree's order
  const VoxelCounts& counts() const { return counts_; }

  // Returns what OpenVDB writes about a tree.
  Metadata Statistics() const;

 private:
  static constexpr int32_t kLeast = std::numeric_limits<int32_t>::min(), kMost = std::numeric_limits<int32_t>::max();

  void Add(const LowerNode& node);
  void AddBrick(const Vec3i& brick, const BrickMask& mask);
  void Grow(const Vec3i& brick, const BrickMask& mask);

  std::map<Vec3i, UpperShape> uppers_;
  VoxelCounts counts_;
  uint64_t leaves_ = 0, lowers_ = 0;
  Vec3i min_ = {kMost, kMost, kMost}, max_ = {kLeast, kLeast, kLeast};  // of all voxels
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_TREE_SURVEY_H_
