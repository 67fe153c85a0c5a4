// A tree that is never in memory: it is written from a sequence of bricks. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_STREAMED_TREE_H_
#define LATVOX_CLIENT_GRID_STREAMED_TREE_H_

#include <map>

#include "client/grid/brick_merge.h"
#include "client/grid/openvdb_trees.h"
#include "client/grid/tree_nodes.h"
#include "client/internal/digest.h"

namespace latvox::client {

// What has to be known of a tree before its first byte is written. Memory: 4 KiB for each node of 4096^3 voxels, of
// which the 131,072 voxels that a mesh may be long on each axis make 33^3 at most: 147 MB.
struct TreeSurvey {
  std::map<openvdb::Coord, Upper::NodeMaskType> uppers;  // by low corner, in the tree's order: which children it has
  uint64_t leaves = 0, lowers = 0, voxels = 0;
  openvdb::CoordBBox box;  // of all voxels
  Digest digest;
};

// Goes through all bricks once. An error is in bricks.status().
TreeSurvey Survey(BrickMerge& bricks);

// The tree of all bricks, for OpenVDB's writer: a .vdb file with it is, byte for byte, the one that holds a BoolTree
// filled with these bricks. The file has the topology of all nodes first and the buffers of all leaves then, so that
// the bricks are gone through twice. Memory: one node of 128^3 voxels, 700 KB. Reading it as a tree finds it empty.
// Writing throws openvdb::IoError when the bricks end in an error, which is in bricks.status(), or are no longer those
// of the survey.
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
