// A brick as a leaf of OpenVDB's BoolTree. Includes OpenVDB's headers. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_TREE_NODES_H_
#define LATVOX_CLIENT_GRID_TREE_NODES_H_

#include <array>
#include <span>

#include "client/grid/brick_tree.h"
#include "client/grid/openvdb_trees.h"
#include "latvox/types.h"

namespace latvox::client {

using Leaf = openvdb::BoolTree::LeafNodeType;
static_assert(Leaf::LOG2DIM == 3 && Leaf::NodeMaskType::WORD_COUNT == 8, "a brick is a leaf");

// Adds the voxels of a mask. A leaf's value mask and its boolean values are the same 512 bits, in the order of a
// brick's words.
inline void AddMask(const std::array<uint64_t, 8>& mask, Leaf& leaf) {
  Leaf::NodeMaskType all = leaf.getValueMask();
  for (openvdb::Index word = 0; word < 8; ++word) all.getWord<openvdb::Index64>(word) |= mask[word];
  leaf.setValueMask(all);
  for (openvdb::Index word = 0; word < 8; ++word) leaf.buffer().data()[word] = all.getWord<openvdb::Index64>(word);
}

// Adds the voxels of bricks. Throws std::bad_alloc.
inline void AddBricks(std::span<const Brick> bricks, openvdb::BoolTree& to) {
  openvdb::tree::ValueAccessor<openvdb::BoolTree> tree(to);
  for (const Brick& brick : bricks) {
    const openvdb::Coord corner(brick.brick_ijk[0] * 8, brick.brick_ijk[1] * 8, brick.brick_ijk[2] * 8);
    AddMask(brick.mask, *tree.touchLeaf(corner));
  }
}

// Does the same, but full bricks are tiles.
inline void AddBricksAndTiles(std::span<const Brick> bricks, openvdb::BoolTree& to) {
  openvdb::tree::ValueAccessor<openvdb::BoolTree> tree(to);
  for (const Brick& brick : bricks) {
    const openvdb::Coord corner(brick.brick_ijk[0] * 8, brick.brick_ijk[1] * 8, brick.brick_ijk[2] * 8);
    if (brick.mask == kFullBrick) {
      tree.addTile(/*level=*/1, corner, /*value=*/true, /*state=*/true);
    } else {
      AddMask(brick.mask, *tree.touchLeaf(corner));
    }
  }
}

// The active voxels of a leaf of any tree of this shape.
template <class AnyLeaf>
Brick ToBrick(const AnyLeaf& leaf) {
  static_assert(AnyLeaf::LOG2DIM == Leaf::LOG2DIM);
  const openvdb::Coord ijk = leaf.origin() >> Leaf::LOG2DIM;
  Brick brick{{ijk[0], ijk[1], ijk[2]}, {}};
  for (openvdb::Index word = 0; word < 8; ++word) {
    brick.mask[word] = leaf.getValueMask().template getWord<openvdb::Index64>(word);
  }
  return brick;
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_TREE_NODES_H_
