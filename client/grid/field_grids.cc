#include "latvox/grid/field_grids.h"

#include <new>
#include <utility>

#include "client/grid/field_forms.h"
#include "client/grid/grid_file.h"
#include "client/grid/grid_metadata.h"
#include "client/grid/metadata_types.h"
#include "client/grid/names_metadata.h"
#include "client/grid/nano_file.h"
#include "client/grid/request_metadata.h"
#include "client/grid/warning_metadata.h"
#include "latvox/grid/openvdb_grid.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {

struct FieldGrids::Content {
  VoxelGrid voxels;
  std::vector<Field> fields;
  std::vector<openvdb::GridBase::Ptr> grids;  // of the fields, one after the other
  std::vector<size_t> ends;                   // of each field's

  openvdb::GridCPtrVec All() {
    openvdb::GridCPtrVec all{voxels.content().grid};
    all.insert(all.end(), grids.begin(), grids.end());
    return all;
  }
};

FieldGrids::FieldGrids(const GridTransform& transform, const std::vector<Field>& fields,
                       const std::vector<uint32_t>& fraction_labels)
    : content_(std::make_unique<Content>(Content{VoxelGrid(transform), fields, {}, {}})) {
  for (const Field field : fields) {
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
  return content_->voxels.Add(batch);
} catch (const std::bad_alloc&) {
  return absl::ResourceExhaustedError("not enough memory for the OpenVDB grids");
}

void FieldGrids::SetRequest(const VoxelizeRequest& request, const MeshNote& note) {
  content_->voxels.SetRequest(request, note);
  for (const openvdb::GridBase::Ptr& grid : content_->grids) DescribeRequest(request, note, *grid);
}

void FieldGrids::SetNames(const CarriedNames& names) {
  for (const Field field : content_->fields) {
    DescribeNames(names, field, *content_->voxels.content().grid);
    for (const openvdb::GridBase::Ptr& grid : content_->grids) DescribeNames(names, field, *grid);
  }
}

void FieldGrids::SetCertificate(const Certificate& certificate) {
  content_->voxels.SetCertificate(certificate);
  for (const openvdb::GridBase::Ptr& grid : content_->grids) Describe(certificate, *grid);
}

void FieldGrids::SetWarnings(const std::vector<Warning>& warnings) {
  content_->voxels.SetWarnings(warnings);
  for (const openvdb::GridBase::Ptr& grid : content_->grids) DescribeWarnings(warnings, *grid);
}

void FieldGrids::SetMetadata(const std::vector<std::pair<std::string, std::string>>& metadata) {
  content_->voxels.SetMetadata(metadata);
  for (const openvdb::GridBase::Ptr& grid : content_->grids) InsertTexts(metadata, *grid);
}

absl::Status FieldGrids::Write(const std::string& path) { return WriteGridFile(content_->All(), path); }

absl::Status FieldGrids::WriteNano(const std::string& path) const { return WriteNanoFile(content_->All(), path); }

}  // namespace latvox::client
