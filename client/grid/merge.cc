#include "latvox/grid/merge.h"

#include <memory>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "client/grid/brick_merge.h"
#include "client/grid/merge_fields.h"
#include "client/grid/openvdb_metadata.h"
#include "client/grid/part_file.h"
#include "client/grid/part_metadata.h"
#include "client/grid/voxel_file.h"

namespace latvox::client {
namespace {

// Survey, topology, buffers.
constexpr uint64_t kPasses = 3;

absl::StatusOr<BrickMerge::Parts> OpenParts(const std::vector<std::string>& paths) {
  if (paths.empty()) return absl::InvalidArgumentError("no part is given");
  BrickMerge::Parts parts;
  for (const std::string& path : paths) {
    auto part = PartFile::Open(path);
    if (!part.ok()) return part.status();
    parts.push_back(*std::move(part));
  }
  return parts;
}

// The tree of all parts. One node is in memory at a time.
class MergedNodes final : public LowerNodes {
 public:
  explicit MergedNodes(BrickMerge& bricks) : bricks_(bricks) {}

  void Rewind() override {
    bricks_.Rewind();
    brick_ = bricks_.Next();
    digest_ = Digest();
  }

  std::shared_ptr<const LowerNode> Next() override {
    if (!brick_) return nullptr;
    TreePlace place = PlaceOf(brick_->brick_ijk);
    const auto node = std::make_shared<LowerNode>(place.upper, place.lower);
    while (place.upper == node->upper && place.lower == node->number) {
      node->Add(place.brick, brick_->mask);
      digest_.Add(*brick_);
      brick_ = bricks_.Next();
      if (!brick_) break;
      place = PlaceOf(brick_->brick_ijk);
    }
    return node;
  }

  const Digest& digest() const { return digest_; }  // of the bricks since Rewind

 private:
  BrickMerge& bricks_;
  const Brick* brick_ = nullptr;
  Digest digest_;
};

std::string BytesOf(const openvdb::math::Transform& transform) {
  std::ostringstream bytes;
  transform.write(bytes);
  return std::move(bytes).str();
}

absl::StatusOr<GridContent> ReadWhole(const std::string& path) { return ReadGridContent(path); }

}  // namespace

absl::StatusOr<MergedGrid> MergeParts(const std::vector<std::string>& paths, const std::string& path,
                                      const Cancellation& cancellation,
                                      const std::function<void(double, uint64_t)>& progress, const ReadPart& read) {
  if (cancellation.cancelled()) return absl::CancelledError("cancelled");
  auto parts = OpenParts(paths);
  if (!parts.ok()) return parts.status();
  const auto common = JoinMetadata(*parts);
  if (!common.ok()) return common.status();
  if (parts->front()->has_fields()) {
    const auto show = [&](size_t parts_read) {
      if (progress) progress(static_cast<double>(parts_read) / static_cast<double>(parts->size() + 1), 0);
    };
    return MergeFields(*parts, *common, read ? read : &ReadWhole, path, cancellation, show);
  }
  const auto show = [&](double passes, uint64_t bricks) {
    if (progress) progress(passes / kPasses, bricks / kPasses);
  };
  const std::string transform = BytesOf(*parts->front()->transform());
  BrickMerge bricks(*std::move(parts), common->shards, cancellation, show);
  MergedNodes nodes(bricks);
  MergedGrid merged;
  const auto describe = [&](const VoxelCounts& counts) {
    if (!bricks.status().ok()) throw std::runtime_error("the parts cannot be read");
    merged = {counts.voxels, counts.bricks, bricks.read() - counts.bricks, nodes.digest().ToHex()};
    Metadata metadata = MetadataOf(common->metadata);
    metadata["latvox_digest"] = ToMetadata(merged.digest);
    metadata.try_emplace("name", ToMetadata(""));
    return metadata;
  };
  const absl::Status written = WriteVoxelFile(nodes, transform, describe, path, cancellation);
  if (!bricks.status().ok()) return bricks.status();
  if (!written.ok()) return written;
  return merged;
}

}  // namespace latvox::client
