#include "latvox/grid/field_grids.h"

#include <new>
#include <utility>

#include "client/grid/field_forms.h"
#include "client/grid/grid_file.h"
#include "client/grid/grid_metadata.h"
#include "client/grid/link_grids.h"
#include "client/grid/metadata_types.h"
#include "client/grid/names_metadata.h"
#include "client/grid/nano_file.h"
#include "client/grid/openvdb_metadata.h"
#include "client/grid/request_metadata.h"
#include "client/grid/tree_nodes.h"
#include "client/grid/warning_metadata.h"
#include "latvox/grid/openvdb_grid.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {
namespace {

absl::Status NotEnoughMemory() { return absl::ResourceExhaustedError("not enough memory for the OpenVDB grids"); }

}  // namespace

struct FieldGrids::Content {
  VoxelGrid voxels;
  std::vector<Field> fields;
  std::vector<Vec3i> neighbors;
  std::vector<openvdb::GridBase::Ptr> grids = {};  // of the fields, one after the other, except those of links
  std::vector<size_t> ends = {};                   // of each field's
  std::vector<FieldValues> links = {};             // the fields of links
  std::vector<Brick> bricks = {};                  // if there are any

  openvdb::GridCPtrVec All() const {
    openvdb::GridCPtrVec all{voxels.content().grid};
    all.insert(all.end(), grids.begin(), grids.end());
    return all;
  }
  LateGrids Late() const { return LinkGrids(bricks, links, neighbors, *voxels.content().grid); }

  void AddLinks(const BrickBatch& batch) {
    if (links.empty()) return;
    bricks.insert(bricks.end(), batch.bricks.begin(), batch.bricks.end());
    for (FieldValues& values : links) {
      const std::vector<std::byte>& more = FindField(batch.fields, values.field)->bytes;
      values.bytes.insert(values.bytes.end(), more.begin(), more.end());
    }
  }
};

FieldGrids::FieldGrids(const GridTransform& transform, const std::vector<Field>& fields,
                       const std::vector<uint32_t>& fraction_labels, const std::vector<Vec3i>& neighbors)
    : content_(std::make_unique<Content>(Content{VoxelGrid(transform), fields, neighbors})) {
  for (const Field field : fields) {
    if (FactsOf(field).is_of_links()) content_->links.push_back({field, {}, neighbors.size()});
    for (openvdb::GridBase::Ptr& grid : NewFieldGrids(field, fraction_labels)) {
      Place(transform, *grid);
      content_->grids.push_back(std::move(grid));
    }
    content_->ends.push_back(content_->grids.size());
  }
}

FieldGrids::FieldGrids(FieldGrids&&) noexcept = default;
FieldGrids& FieldGrids::operator=(FieldGrids&&) noexcept = default;
FieldGrids::~FieldGrids() = default;

absl::Status FieldGrids::Add(const BrickBatch& batch) try {
  size_t begin = 0;
  for (size_t n = 0; n < content_->fields.size(); ++n) {
    const size_t end = content_->ends[n];
    for (size_t grid = begin; grid < end; ++grid) {
      FillFieldGrid(batch.bricks, batch.fields[n], *content_->grids[grid], grid - begin);
    }
    begin = end;
  }
  content_->AddLinks(batch);
  AddBricks(batch.bricks, content_->voxels.content().grid->tree());
  return absl::OkStatus();
} catch (const std::bad_alloc&) {
  return NotEnoughMemory();
}

void FieldGrids::SetRequest(const VoxelizeRequest& request, const MeshNote& note) {
  content_->voxels.SetRequest(request, note);
  for (const openvdb::GridBase::Ptr& grid : content_->grids) InsertMetadata(RequestMetadata(request, note), *grid);
}

void FieldGrids::SetNames(const CarriedNames& names) {
  for (const Field field : content_->fields) {
    InsertMetadata(NamesMetadata(names, field), *content_->voxels.content().grid);
    for (const openvdb::GridBase::Ptr& grid : content_->grids) InsertMetadata(NamesMetadata(names, field), *grid);
  }
}

void FieldGrids::SetCertificate(const Certificate& certificate) {
  content_->voxels.SetCertificate(certificate);
  for (const openvdb::GridBase::Ptr& grid : content_->grids) InsertMetadata(CertificateMetadata(certificate), *grid);
}

void FieldGrids::SetWarnings(const std::vector<Warning>& warnings) {
  content_->voxels.SetWarnings(warnings);
  for (const openvdb::GridBase::Ptr& grid : content_->grids) InsertMetadata(WarningMetadata(warnings), *grid);
}

void FieldGrids::SetMetadata(const std::vector<std::pair<std::string, std::string>>& metadata) {
  content_->voxels.SetMetadata(metadata);
  for (const openvdb::GridBase::Ptr& grid : content_->grids) InsertMetadata(TypedMetadata(metadata), *grid);
}

absl::Status FieldGrids::Write(const std::string& path, const Cancellation& cancellation) try {
  return WriteGridFile(content_->All(), path, content_->Late(), cancellation);
} catch (const std::bad_alloc&) {
  return NotEnoughMemory();
}

absl::Status FieldGrids::WriteNano(const std::string& path, const Cancellation& cancellation) const try {
  return WriteNanoFile(content_->All(), path, content_->Late(), cancellation);
} catch (const std::bad_alloc&) {
  return NotEnoughMemory();
}

}  // namespace latvox::client
