// The front of a part: its metadata, and where its leaves lie. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_PART_FRAME_H_
#define LATVOX_CLIENT_GRID_PART_FRAME_H_

#include <cstdint>
#include <istream>
#include <string>

#include "client/grid/tree_nodes.h"

namespace latvox::client {

struct PartFrame {
  openvdb::GridBase::Ptr grid;  // with metadata and transform, without voxels
  std::string digest;           // from the metadata: latvox_digest
  bool has_fields = false;      // or is a band; then the leaves are not given
  bool is_nano = false;
  uint64_t leaves_at = 0;  // place in the file
  uint64_t leaves = 0;     // one after the other, in the tree's order (TreePlace)
};

// Read the frame, and check each length in it. They throw std::runtime_error with the reason; exceptions of OpenVDB;
// and std::ios_base::failure at the end of the file.
PartFrame ReadVdbPart(std::istream& in, uint64_t size);
PartFrame ReadNanoPart(std::istream& in);

// Read the next leaf, with its values as they are in the file. Throw std::ios_base::failure at the end of the file.
//
//   .vdb, 140 bytes   64   mask of active voxels
//                     12   i, j, k of the low corner, little-endian 32-bit
//                     64   values
//   .nvdb             a leaf of NanoVDB's grid of bool
inline constexpr uint64_t kVdbLeafBytes = 140;
void ReadVdbLeaf(std::istream& in, Leaf& leaf);
void ReadNanoLeaf(std::istream& in, Leaf& leaf);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_PART_FRAME_H_
