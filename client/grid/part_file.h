// One part of a voxelization: a .vdb or .nvdb file that `latvox voxelize` wrote, read brick by brick. Internal to
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
#include "client/grid/brick_tree.h"
#include "client/grid/part_frame.h"
#include "client/internal/digest.h"

namespace latvox::client {

// Reads metadata and transform, and the topology of the tree: a brick is a leaf, or of a tile.
//
// Memory: that of PartTree, and 64 KiB. Not thread-safe. Errors, in status() or returned, name the path. They are
// INVALID_ARGUMENT unless said otherwise.
class PartFile {
 public:
  // Errors: NOT_FOUND; RESOURCE_EXHAUSTED (open files); a file that latvox did not write; a file that is cut short; a
  // .nvdb file that is compressed.
  static absl::StatusOr<std::unique_ptr<PartFile>> Open(const std::string& path);

  const std::string& path() const { return path_; }
  const openvdb::MetaMap& metadata() const { return *frame_.grid; }
  openvdb::math::Transform::Ptr transform() const { return frame_.grid->transformPtr(); }
  const std::string& digest() const { return frame_.digest; }  // from the metadata: latvox_digest
  bool has_fields() const { return frame_.has_fields; }        // or is a band; then it has no bricks here
  double share() const;                                        // of the bricks, read since Rewind

  // Goes back to the place before the first brick.
  void Rewind();

  // Returns the next brick, in the order of TreePlace; null at the end, and on an error. Valid until the next call. A
  // part that was read to its end has the digest of its metadata.
  const Brick* Next();

  const absl::Status& status() const { return status_; }

 private:
  explicit PartFile(const std::string& path) : path_(path), buffer_(size_t{1} << 16) {}
  absl::Status OpenStream();
  template <class Read>
  void Guard(const Read& read);  // calls it, and sets the status for what it throws
  bool ReadBrick();
  void CheckDigest();

  const std::string path_;
  std::vector<char> buffer_;
  std::ifstream file_;
  PartFrame frame_;
  uint64_t read_ = 0;
  Brick brick_{};
  std::optional<TreePlace> place_;  // of brick_; absent before the first one
  Digest digest_;
  absl::Status status_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_PART_FILE_H_
