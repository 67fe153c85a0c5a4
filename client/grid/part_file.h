// One part of a voxelization: a .vdb or .nvdb file that `latvox voxelize` wrote, read leaf by leaf. Internal to
// latvox::grid.
#ifndef LATVOX_CLIENT_GRID_PART_FILE_H_
#define LATVOX_CLIENT_GRID_PART_FILE_H_

#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/grid/part_frame.h"
#include "client/grid/tree_nodes.h"
#include "client/internal/digest.h"

namespace latvox::client {

// Reads metadata and transform, and only the leaves of the tree, which have the tree's order (TreePlace).
//
// Memory: 64 KiB. Not thread-safe. Errors, in status() or returned, name the path. They are INVALID_ARGUMENT unless
// said otherwise.
class PartFile {
 public:
  // Errors: NOT_FOUND; RESOURCE_EXHAUSTED (open files); a file that latvox did not write; a file that is cut short; a
  // .nvdb file that is compressed.
  static absl::StatusOr<std::unique_ptr<PartFile>> Open(const std::string& path);

  const std::string& path() const { return path_; }
  const openvdb::MetaMap& metadata() const { return *frame_.grid; }
  openvdb::math::Transform::Ptr transform() const { return frame_.grid->transformPtr(); }
  const std::string& digest() const { return frame_.digest; }  // from the metadata: latvox_digest
  bool has_fields() const { return frame_.has_fields; }        // or is a band; then it has no leaves here
  uint64_t leaves() const { return frame_.leaves; }

  // Goes back to the place before the first leaf.
  void Rewind();

  // Returns the next leaf; null at the end, and on an error. Valid until the next call. A part that was read to its end
  // has the digest of its metadata.
  const Leaf* Next();

  const absl::Status& status() const { return status_; }

 private:
  explicit PartFile(const std::string& path) : path_(path), buffer_(size_t{1} << 16) {}
  absl::Status OpenStream();
  void ReadLeaf();
  void CheckDigest();

  const std::string path_;
  std::vector<char> buffer_;
  std::ifstream file_;
  PartFrame frame_;
  uint64_t read_ = 0;
  Leaf leaf_;
  std::optional<TreePlace> place_;  // of leaf_; absent before the first leaf
  Digest digest_;
  absl::Status status_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_PART_FILE_H_
