// One part of a voxelization: a .vdb file that `latvox voxelize` wrote, read brick by brick. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_PART_FILE_H_
#define LATVOX_CLIENT_GRID_PART_FILE_H_

#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/grid/tree_nodes.h"
#include "client/internal/digest.h"

namespace latvox::client {

// OpenVDB reads the file's frame and metadata. This class reads only the last section of the tree, the leaves' buffers:
//
//   bytes    140 for each leaf, in the tree's order (TreePlace)
//            64   mask of active voxels; at least one is set
//            12   i, j, k of the low corner, little-endian 32-bit
//            64   values: the same bits
//
// Memory: 64 KiB. Not thread-safe. Errors, in status() or returned, name the path. They are INVALID_ARGUMENT unless
// said otherwise.
class PartFile {
 public:
  // Errors: NOT_FOUND; RESOURCE_EXHAUSTED (open files); a file that latvox did not write; a file that is cut short.
  static absl::StatusOr<std::unique_ptr<PartFile>> Open(const std::string& path);

  const std::string& path() const { return path_; }
  const openvdb::MetaMap& metadata() const { return *grid_; }
  openvdb::math::Transform::Ptr transform() const { return grid_->transformPtr(); }
  const std::string& digest() const { return recorded_; }  // from the metadata: latvox_digest
  bool has_fields() const { return has_fields_; }          // or is a band; then it has no leaves here
  uint64_t leaves() const { return leaves_; }

  // Goes back to the place before the first leaf.
  void Rewind();

  // Returns the next leaf; null at the end, and on an error. Valid until the next call. A part that was read to its end
  // has the digest of its metadata.
  const Leaf* Next();

  const absl::Status& status() const { return status_; }

 private:
  explicit PartFile(const std::string& path) : path_(path), buffer_(size_t{1} << 16) {}
  absl::Status OpenStream();
  void ReadFrame();
  void ReadLeaf();
  void CheckDigest();

  const std::string path_;
  std::vector<char> buffer_;
  std::ifstream file_;
  openvdb::GridBase::Ptr grid_;
  std::string recorded_;
  bool has_fields_ = false;
  int64_t leaves_begin_ = 0;
  uint64_t leaves_ = 0, read_ = 0;
  Leaf leaf_;
  std::optional<TreePlace> place_;  // of leaf_; absent before the first leaf
  Digest digest_;
  absl::Status status_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_PART_FILE_H_
