#include "client/grid/tree_survey.h"

#include <openvdb/tree/Tree.h>  // of OpenVDB's headers, this one needs no part of its library

#include <algorithm>
#include <array>
#include <bit>

namespace latvox::client {
namespace {

// The nodes of OpenVDB's tree, whose sizes in memory a file tells.
using Tree = openvdb::tree::Tree4<bool, 5, 4, 3>::Type;
using Root = Tree::RootNodeType;
using Upper = Root::ChildNodeType;
using Lower = Upper::ChildNodeType;
using Leaf = Lower::ChildNodeType;
static_assert(Upper::NUM_VALUES == kLowersOfUpper && Lower::NUM_VALUES == kBricksOfLower);
static_assert(sizeof(Upper::NodeMaskType) == UpperMask::kBytes && sizeof(Lower::NodeMaskType) == LowerMask::kBytes);

// A node's memory without its children, as OpenVDB counts it.
template <class Node>
constexpr uint64_t BytesOf() {
  return Node::NUM_VALUES * sizeof(typename Node::UnionType) + 2 * sizeof(typename Node::NodeMaskType) +
         sizeof(openvdb::Coord);
}

}  // namespace

TreeSurvey::TreeSurvey(LowerNodes& nodes) {
  nodes.Rewind();
  while (const auto node = nodes.Next()) Add(*node);
}

Metadata TreeSurvey::Statistics() const {
  const auto full =
      static_cast<uint64_t>(std::ranges::count_if(uppers_, [](const auto& upper) { return upper.second.is_full(); }));
  const uint64_t memory = sizeof(Tree) + sizeof(Root) + (uppers_.size() - full) * BytesOf<Upper>() +
                          lowers_ * BytesOf<Lower>() + leaves_ * sizeof(Leaf);
  return {{"file_bbox_min", ToMetadata(min_)},
          {"file_bbox_max", ToMetadata(max_)},
          {"file_mem_bytes", ToMetadata(static_cast<int64_t>(memory))},
          {"file_voxel_count", ToMetadata(static_cast<int64_t>(counts_.voxels))}};
}

void TreeSurvey::Add(const LowerNode& node) {
  UpperShape& upper = uppers_.try_emplace(node.upper, UpperShape{node.number}).first->second;
  if (node.is_full()) {
    upper.tiles.Set(node.number);
    ++upper.full;
  } else {
    upper.children.Set(node.number);
    ++lowers_;
  }
  TreePlace place{node.upper, node.number};
  if (node.is_full()) {
    counts_.bricks += kBricksOfLower;
    counts_.voxels += uint64_t{kBricksOfLower} * 512;
    for (const uint32_t number : {uint32_t{0}, kBricksOfLower - 1}) {
      place.brick = number;
      Grow(BrickAt(place), kFullBrick);
    }
    return;
  }
  node.tiles().ForEach([&](uint32_t number) {
    place.brick = number;
    AddBrick(BrickAt(place), kFullBrick);
  });
  node.ForEachLeaf([&](uint32_t number, const BrickMask& mask) {
    place.brick = number;
    AddBrick(BrickAt(place), mask);
    ++leaves_;
  });
}

void TreeSurvey::AddBrick(const Vec3i& brick, const BrickMask& mask) {
  ++counts_.bricks;
  for (const uint64_t word : mask) counts_.voxels += static_cast<uint64_t>(std::popcount(word));
  for (size_t axis = 0; axis < 3; ++axis) {
    const int32_t low = brick[axis] * 8;
    if (low < min_[axis] || low + 7 > max_[axis]) return Grow(brick, mask);
  }
}

// Voxel (x, y, z) of a brick is bit 8 y + z of word x.
void TreeSurvey::Grow(const Vec3i& brick, const BrickMask& mask) {
  uint64_t any = 0;
  std::array<uint32_t, 3> used{};  // along each axis
  for (uint32_t x = 0; x < 8; ++x) {
    any |= mask[x];
    used[0] |= uint32_t{mask[x] != 0} << x;
  }
  for (uint32_t y = 0; y < 8; ++y) {
    const auto row = static_cast<uint32_t>(any >> 8 * y & 0xFF);
    used[1] |= uint32_t{row != 0} << y;
    used[2] |= row;
  }
  for (size_t axis = 0; axis < 3; ++axis) {
    const int32_t low = brick[axis] * 8;
    min_[axis] = std::min(min_[axis], low + std::countr_zero(used[axis]));
    max_[axis] = std::max(max_[axis], low + static_cast<int32_t>(std::bit_width(used[axis])) - 1);
  }
}

}  // namespace latvox::client
