// The bricks of a part. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_PART_TREE_H_
#define LATVOX_CLIENT_GRID_PART_TREE_H_

#include <cstdint>
#include <istream>
#include <memory>
#include <optional>
#include <vector>

#include "client/grid/brick_tree.h"
#include "latvox/types.h"

namespace latvox::client {

// Goes through a tree in a file. Tiles are full bricks. Functions throw std::runtime_error with the reason, and
// std::ios_base::failure at the end of the file. Memory: 9 KB and 12 bytes for each tile of the root. Not thread-safe.
class PartTree {
 public:
  virtual ~PartTree() = default;

  // Goes back to the place before the first brick.
  void Rewind();

  // Sets the next brick, in the order of TreePlace if the file is not damaged. False at the end.
  bool Next(Brick& brick);

  // How much Next reads, and has read since Rewind, in some unit.
  uint64_t size() const { return size_; }
  virtual uint64_t read() const = 0;

 protected:
  explicit PartTree(uint64_t size) : size_(size) {}

  virtual void ReadRoot() = 0;
  virtual bool ReadUpper(Vec3i& corner, UpperMask& children, UpperMask& tiles) = 0;  // false at the end
  virtual void ReadLower(const TreePlace& first, LowerMask& children, LowerMask& tiles) = 0;
  virtual void ReadLeaf(const TreePlace& place, BrickMask& mask) = 0;

 private:
  bool NextLower();

  const uint64_t size_;
  TreePlace next_;  // the child after the last one, in both nodes
  UpperMask lowers_, lower_tiles_;
  LowerMask leaves_, tiles_;
};

// The tree of a .vdb file between two places of the file, where the topology begins and ends. Behind it, there must be
// `leaves` leaves.
std::unique_ptr<PartTree> NewVdbTree(std::istream& in, uint64_t begin, uint64_t end, uint64_t leaves);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_PART_TREE_H_
