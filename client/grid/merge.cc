#include "latvox/grid/merge.h"

#include <memory>
#include <utility>

#include "client/grid/brick_merge.h"
#include "client/grid/grid_file.h"
#include "client/grid/merge_fields.h"
#include "client/grid/part_file.h"
#include "client/grid/part_metadata.h"
#include "client/grid/streamed_tree.h"

namespace latvox::client {
namespace {

// Survey, topology, buffers.
constexpr int kPasses = 3;

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

openvdb::GridBase::Ptr MakeGrid(const PartFile& part, const openvdb::MetaMap& metadata, const Digest& digest) {
  auto grid = openvdb::BoolGrid::create(false);
  grid->insertMeta(metadata);
  grid->insertMeta("latvox_digest", openvdb::StringMetadata(digest.ToHex()));
  grid->setTransform(part.transform());
  return grid;
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
  uint64_t leaves = 0;
  for (const auto& part : *parts) leaves += part->leaves();
  const PartFile& first = *parts->front();
  const double steps = static_cast<double>(kPasses * (leaves + parts->size()));
  const auto show = [&](uint64_t leaves_read) {
    if (progress) progress(static_cast<double>(leaves_read) / steps, leaves_read / kPasses);
  };

  BrickMerge bricks(*std::move(parts), common->shards, cancellation, show);
  const TreeSurvey survey = Survey(bricks);
  if (!bricks.status().ok()) return bricks.status();
  const auto grid = MakeGrid(first, common->metadata, survey.digest);
  grid->setTree(std::make_shared<StreamedTree>(survey, bricks));
  const absl::Status written = WriteGridFile({grid}, path);
  if (!bricks.status().ok()) return bricks.status();
  if (!written.ok()) return written;
  return MergedGrid{survey.voxels, survey.leaves, leaves - survey.leaves, survey.digest.ToHex()};
}

}  // namespace latvox::client
