// A tree that is never in memory: it is written from a sequence of bricks. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_STREAMED_TREE_H_
#define LATVOX_CLIENT_GRID_STREAMED_TREE_H_

#include <map>

#include "client/grid/brick_merge.h"
#include "client/grid/openvdb_trees.h"
#include "client/grid/tree_nodes.h"
#include "client/internal/digest.h"

namespace latvox::client {

// The facts about a tree that its first byte depends on. Memory: 4 KiB for each node of 4096^3 voxels. A mesh may be
// 131,072 voxels long on each axis, so there are at most 33^3 nodes: 147 MB.
struct TreeSurvey {
  std::map<openvdb::Coord, Upper::NodeMaskType> uppers;  // by low corner, in the tree's order: the children that it has
  uint64_t leaves = 0, lowers = 0, voxels = 0;
  openvdb::CoordBBox box;  // of all voxels
  Digest digest;
};

// Goes through all bricks once. An error is in bricks.status().
TreeSurvey Survey(BrickMerge& bricks);

// The tree of all bricks, for OpenVDB's writer. A .vdb file with it equals, byte for byte, the file of a BoolTree
// filled with these bricks. The file has the topology of all nodes first, and then the buffers of all leaves, so the
// bricks are read twice. Memory: one node of 128^3 voxels, 700 KB. Read as a tree, it is empty. Writing throws
// openvdb::IoError if the bricks end in an error, which is in bricks.status(), or differ from those of the survey.
class StreamedTree final : public openvdb::BoolTree {
 public:
  // Both must outlive the tree.
  StreamedTree(const TreeSurvey& survey, BrickMerge& bricks) : Tree(false), survey_(survey), bricks_(bricks) {}

  void writeTopology(std::ostream& out, bool to_half) const override;
  void writeBuffers(std::ostream& out, bool to_half) const override;
  openvdb::Index64 activeVoxelCount() const override { return survey_.voxels; }
  bool evalActiveVoxelBoundingBox(openvdb::CoordBBox& box) const override;
  openvdb::Index64 memUsage() const override;

 private:
  const TreeSurvey& survey_;
  BrickMerge& bricks_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_STREAMED_TREE_H_
