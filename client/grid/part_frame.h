// The front of a part: its metadata, and where its leaves lie. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_PART_FRAME_H_
#define LATVOX_CLIENT_GRID_PART_FRAME_H_

#include <cstdint>
#include <istream>
#include <memory>
#include <string>

#include "client/grid/openvdb_trees.h"
#include "client/grid/part_tree.h"

namespace latvox::client {

struct PartFrame {
  openvdb::GridBase::Ptr grid;  // with metadata and transform, without voxels
  std::string digest;           // from the metadata: latvox_digest
  bool has_fields = false;      // or is a band; then the tree is not given
  std::unique_ptr<PartTree> tree;
};

// Read the frame, and check each length in it. `in` must outlive the tree. They throw std::runtime_error with the
// reason; exceptions of OpenVDB; and std::ios_base::failure at the end of the file.
PartFrame ReadVdbPart(std::istream& in, uint64_t size);
PartFrame ReadNanoPart(std::istream& in);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_PART_FRAME_H_
