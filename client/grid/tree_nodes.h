// The nodes of OpenVDB's BoolTree, and a brick as a leaf of it. Includes OpenVDB's headers. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_TREE_NODES_H_
#define LATVOX_CLIENT_GRID_TREE_NODES_H_

#include <array>
#include <compare>
#include <span>

#include "client/grid/openvdb_trees.h"
#include "latvox/types.h"

namespace latvox::client {

using Upper = openvdb::BoolTree::RootNodeType::ChildNodeType;  // 4096^3 voxels, a child of the root
using Lower = Upper::ChildNodeType;                            // 128^3 voxels
using Leaf = openvdb::BoolTree::LeafNodeType;                  // 8^3 voxels: a brick
static_assert(Upper::DIM == 4096 && Lower::DIM == 128);
static_assert(Leaf::LOG2DIM == 3 && Leaf::NodeMaskType::WORD_COUNT == 8, "a brick is a leaf");

// The place of a leaf in its tree, ordered like OpenVDB's iteration, which is also the order of writing.
struct TreePlace {
  Vec3i upper{};       // low corner of the node of 4096^3 voxels
  uint32_t lower = 0;  // the child's number in that node
  uint32_t leaf = 0;   // the child's number in that node
  auto operator<=>(const TreePlace&) const = default;
};

inline TreePlace PlaceOf(const openvdb::Coord& ijk) {
  const openvdb::Coord upper = ijk & ~static_cast<int32_t>(Upper::DIM - 1);
  return {{upper[0], upper[1], upper[2]}, Upper::coordToOffset(ijk), Lower::coordToOffset(ijk)};
}

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
