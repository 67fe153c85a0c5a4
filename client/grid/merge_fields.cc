#include "client/grid/merge_fields.h"

#include <cstddef>
#include <exception>
#include <new>
#include <span>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/grid/band_grid.h"
#include "client/grid/content_join.h"
#include "client/grid/field_forms.h"
#include "client/grid/grid_file.h"
#include "client/grid/link_grids.h"
#include "client/grid/openvdb_metadata.h"
#include "client/grid/openvdb_trees.h"
#include "client/grid/tree_nodes.h"
#include "client/internal/digest.h"
#include "latvox/for_each_voxel.h"
#include "latvox/grid/grid_content.h"

namespace latvox::client {
namespace {

using Parts = std::vector<std::unique_ptr<PartFile>>;

// The digests of a set and of its fields.
struct Digests {
  Digest set;
  std::vector<Digest> fields;
};

Digests DigestsOf(const std::vector<Brick>& bricks, const std::vector<FieldValues>& fields) {
  Digests digests{{}, std::vector<Digest>(fields.size())};
  uint64_t before = 0;
  for (const Brick& brick : bricks) {
    const size_t voxels = CountVoxels(brick);
    digests.set.Add(brick);
    for (size_t n = 0; n < fields.size(); ++n) {
      const size_t bytes = fields[n].bytes_of_voxel();
      digests.fields[n].Add(brick, std::span(fields[n].bytes).subspan(before * bytes, voxels * bytes));
    }
    before += voxels;
  }
  return digests;
}

std::string DigestName(Field field) { return absl::StrCat("latvox_", NameOf(field), "_digest"); }

absl::Status CheckDigest(const std::string& path, const std::string& name, const std::string& found,
                         const std::string& recorded) {
  if (found == recorded) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(path, ": is damaged: its voxels have digest ", found, ", but ", name, " is ", recorded));
}

absl::Status CheckDigests(const PartFile& part, const GridContent& content) {
  const Digests digests = DigestsOf(content.file.bricks, content.fields);
  if (auto status = CheckDigest(part.path(), "latvox_digest", digests.set.ToHex(), part.digest()); !status.ok()) {
    return status;
  }
  for (size_t n = 0; n < content.fields.size(); ++n) {
    const std::string name = DigestName(content.fields[n].field);
    const auto recorded = part.metadata().getMetadata<openvdb::StringMetadata>(name);
    if (!recorded) return absl::InvalidArgumentError(absl::StrCat(part.path(), ": its metadata has no ", name));
    if (auto status = CheckDigest(part.path(), name, digests.fields[n].ToHex(), recorded->value()); !status.ok()) {
      return status;
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<PartContent>> ReadParts(const Parts& parts, const ReadPart& read,
                                                   const Cancellation& cancellation,
                                                   const std::function<void(size_t)>& progress) {
  std::vector<PartContent> contents;
  for (const auto& part : parts) {
    if (cancellation.cancelled()) return absl::CancelledError("cancelled");
    auto content = read(part->path());
    if (!content.ok()) return content.status();
    if (auto status = CheckDigests(*part, *content); !status.ok()) return status;
    contents.push_back({part->path(), *std::move(content)});
    progress(contents.size());
  }
  return contents;
}

// A band of a whole has an inside. Regions and bounds may leave something out.
bool IsWhole(const CommonFacts& common) {
  return common.shards && !common.metadata["latvox_region"] && !common.metadata["latvox_bounds"];
}

openvdb::GridBase::Ptr NewBand(const GridContent& first, const CommonFacts& common, const JoinedContent& joined) {
  const DistanceRange range = first.distances.value_or(DistanceRange{});
  const auto grid = NewBandGrid(first.file.info.transform.basis, range.most, range.is_signed, IsWhole(common));
  FillFieldGrid(joined.bricks, joined.fields.front(), *grid);
  FillInside(*grid);
  return grid;
}

std::vector<openvdb::GridBase::Ptr> NewGrids(const GridContent& first, const CommonFacts& common,
                                             const JoinedContent& joined) {
  if (first.is_band) return {NewBand(first, common, joined)};
  const auto set = openvdb::BoolGrid::create(false);
  set->setName(first.file.info.name);
  AddBricks(joined.bricks, set->tree());
  std::vector<openvdb::GridBase::Ptr> grids = {set};
  for (const FieldValues& values : joined.fields) {
    const auto of_field = NewFieldGrids(values.field, values.labels);
    for (size_t n = 0; n < of_field.size(); ++n) {
      FillFieldGrid(joined.bricks, values, *of_field[n], n);
      grids.push_back(of_field[n]);
    }
  }
  return grids;
}

void DescribeWhole(const CommonFacts& common, const JoinedContent& joined, const Digests& digests,
                   openvdb::GridBase& grid) {
  InsertMetadata(common.metadata, grid);
  grid.insertMeta("latvox_digest", openvdb::StringMetadata(digests.set.ToHex()));
  for (size_t n = 0; n < joined.fields.size(); ++n) {
    grid.insertMeta(DigestName(joined.fields[n].field), openvdb::StringMetadata(digests.fields[n].ToHex()));
  }
}

}  // namespace

absl::StatusOr<MergedGrid> MergeFields(const Parts& parts, const CommonFacts& common, const ReadPart& read,
                                       const std::string& path, const Cancellation& cancellation,
                                       const std::function<void(size_t)>& progress) try {
  auto contents = ReadParts(parts, read, cancellation, progress);
  if (!contents.ok()) return contents.status();
  auto joined = JoinContents(*contents, common.shards);
  if (!joined.ok()) return joined.status();
  GridContent& first = contents->front().content;
  first.fields.clear();
  contents->resize(1);
  const Digests digests = DigestsOf(joined->bricks, joined->fields);
  const auto grids = NewGrids(first, common, *joined);
  uint64_t voxels = 0;
  for (const Brick& brick : joined->bricks) voxels += CountVoxels(brick);
  for (const openvdb::GridBase::Ptr& grid : grids) {
    DescribeWhole(common, *joined, digests, *grid);
    grid->setTransform(parts.front()->transform());
  }
  if (cancellation.cancelled()) return absl::CancelledError("cancelled");
  const LateGrids links = LinkGrids(joined->bricks, joined->fields, joined->neighbors, *grids.front());
  const absl::Status written = WriteGridFile({grids.begin(), grids.end()}, path, links, cancellation);
  if (!written.ok()) return written;
  return MergedGrid{voxels, joined->bricks.size(), joined->shared_bricks, digests.set.ToHex()};
} catch (const std::bad_alloc&) {
  return absl::ResourceExhaustedError(absl::StrCat(path, ": not enough memory to join the fields"));
} catch (const std::exception& error) {
  return absl::UnknownError(absl::StrCat(path, ": the grids cannot be made (", error.what(), ")"));
}

}  // namespace latvox::client
