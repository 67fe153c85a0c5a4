// Bricks in the tree of OpenVDB's BoolTree, without OpenVDB. Internal to latvox::grid and the tool.
#ifndef LATVOX_CLIENT_GRID_BRICK_TREE_H_
#define LATVOX_CLIENT_GRID_BRICK_TREE_H_

#include <array>
#include <bit>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <span>

#include "latvox/types.h"

namespace latvox::client {

// Three levels: upper nodes of 4096^3 voxels, in them lower nodes of 128^3, in them bricks, the leaves, of 8^3.
inline constexpr uint32_t kLowersOfUpper = 32 * 32 * 32, kBricksOfLower = 16 * 16 * 16;

// The children of a node: child (x, y, z) of n^3 is bit (x * n + y) * n + z, and bit b is bit b % 64 of word b / 64.
template <uint32_t children>
class NodeMask {
 public:
  bool Has(uint32_t child) const { return (words_[child / 64] >> child % 64 & 1) != 0; }
  void Set(uint32_t child) { words_[child / 64] |= uint64_t{1} << child % 64; }
  void Clear(uint32_t child) { words_[child / 64] &= ~(uint64_t{1} << child % 64); }
  void Fill() { words_.fill(~uint64_t{0}); }

  uint32_t Count() const {
    uint32_t count = 0;
    for (const uint64_t word : words_) count += static_cast<uint32_t>(std::popcount(word));
    return count;
  }

  // Calls visit(child) for each of them, in ascending order.
  template <class Visit>
  void ForEach(const Visit& visit) const {
    for (uint32_t n = 0; n < words_.size(); ++n) {
      for (uint64_t bits = words_[n]; bits != 0; bits &= bits - 1) {
        visit(n * 64 + static_cast<uint32_t>(std::countr_zero(bits)));
      }
    }
  }

  // The bytes of a file.
  char* data() { return reinterpret_cast<char*>(words_.data()); }
  const char* data() const { return reinterpret_cast<const char*>(words_.data()); }
  static constexpr size_t kBytes = children / 8;

 private:
  std::array<uint64_t, children / 64> words_{};
};
using UpperMask = NodeMask<kLowersOfUpper>;
using LowerMask = NodeMask<kBricksOfLower>;
using BrickMask = std::array<uint64_t, 8>;

inline constexpr uint64_t kAllVoxels = ~uint64_t{0};
inline constexpr BrickMask kFullBrick = {kAllVoxels, kAllVoxels, kAllVoxels, kAllVoxels,
                                         kAllVoxels, kAllVoxels, kAllVoxels, kAllVoxels};

// The place of a brick in the tree, ordered like OpenVDB's iteration, which is also the order of writing.
struct TreePlace {
  Vec3i upper{};       // low corner of the upper node, in voxels
  uint32_t lower = 0;  // the child's number in that node
  uint32_t brick = 0;  // the child's number in that node
  auto operator<=>(const TreePlace&) const = default;
};
TreePlace PlaceOf(const Vec3i& brick_ijk);

// Returns the coordinates of a brick. The inverse of PlaceOf.
Vec3i BrickAt(const TreePlace& place);

// A lower node. Memory: 1.7 KB, and about 76 bytes for each brick that is not full.
class LowerNode {
 public:
  Vec3i upper;      // low corner of the upper node
  uint32_t number;  // in that node

  LowerNode(const Vec3i& corner, uint32_t child) : upper(corner), number(child) {}

  // Adds the voxels to those of the brick with this number. Precondition: there are some.
  void Add(uint32_t child, const BrickMask& mask);

  const LowerMask& leaves() const { return leaves_; }  // bricks that lack voxels
  const LowerMask& tiles() const { return tiles_; }    // full bricks
  bool is_full() const { return masks_.empty() && tiles_.Count() == kBricksOfLower; }

  // Calls visit(child, mask) for each leaf, in ascending order.
  template <class Visit>
  void ForEachLeaf(const Visit& visit) const {
    std::array<const BrickMask*, kBricksOfLower> masks;
    for (const Leaf& leaf : masks_) masks[leaf.number] = &leaf.mask;
    leaves_.ForEach([&](uint32_t child) { visit(child, *masks[child]); });
  }

 private:
  struct Leaf {
    BrickMask mask;
    uint16_t number;
  };

  LowerMask leaves_, tiles_;
  std::deque<Leaf> masks_;  // of the leaves, in any order
};

// A tree as a sequence of lower nodes, in the order of TreePlace.
class LowerNodes {
 public:
  virtual ~LowerNodes() = default;

  // Goes back to the place before the first node.
  virtual void Rewind() = 0;

  // Returns the next node, which is not empty; null at the end.
  virtual std::shared_ptr<const LowerNode> Next() = 0;
};

// A tree that is being filled. Not thread-safe.
class BrickTree final : public LowerNodes {
 public:
  // Adds voxels, in any order. Throws std::bad_alloc.
  void Add(std::span<const Brick> bricks);

  void Rewind() override { next_ = nodes_.begin(); }
  std::shared_ptr<const LowerNode> Next() override { return next_ == nodes_.end() ? nullptr : (next_++)->second; }

 private:
  using Nodes = std::map<TreePlace, std::shared_ptr<LowerNode>>;  // by the place of their first brick

  Nodes nodes_;
  Nodes::iterator last_ = nodes_.end(), next_ = nodes_.begin();
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_BRICK_TREE_H_
