#include "latvox/grid/attribute_grids.h"

#include <new>
#include <utility>

#include "client/grid/fill_grid.h"
#include "client/grid/grid_file.h"
#include "client/grid/grid_metadata.h"
#include "client/grid/names_metadata.h"
#include "client/grid/openvdb_trees.h"
#include "client/grid/request_metadata.h"
#include "client/grid/warning_metadata.h"
#include "latvox/grid/openvdb_grid.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {
namespace {

openvdb::GridBase::Ptr NewGrid(const GridTransform& transform, Attribute attribute) {
  openvdb::GridBase::Ptr grid;
  if (attribute == Attribute::kColor) {
    grid = openvdb::Vec3SGrid::create();
  } else {
    grid = openvdb::Int32Grid::create(-1);
  }
  grid->setName(NameOf(attribute));
  Place(transform, *grid);
  return grid;
}

openvdb::Vec3s ToColor(uint32_t number) {
  const auto part = [number](int shift) { return static_cast<float>(number >> shift & 0xFF) / 255; };
  return {part(16), part(8), part(0)};
}

}  // namespace

struct AttributeGrids::Content {
  VoxelGrid voxels;
  std::vector<Attribute> attributes;
  std::vector<openvdb::GridBase::Ptr> grids;  // of the attributes
};

AttributeGrids::AttributeGrids(const GridTransform& transform, const std::vector<Attribute>& attributes)
    : content_(std::make_unique<Content>(Content{VoxelGrid(transform), attributes, {}})) {
  for (const Attribute attribute : attributes) content_->grids.push_back(NewGrid(transform, attribute));
}

AttributeGrids::AttributeGrids(AttributeGrids&&) noexcept = default;
AttributeGrids& AttributeGrids::operator=(AttributeGrids&&) noexcept = default;
AttributeGrids::~AttributeGrids() = default;

absl::Status AttributeGrids::Add(const BrickBatch& batch) try {
  const size_t count = content_->attributes.size();
  for (size_t n = 0; n < count; ++n) {
    openvdb::GridBase& grid = *content_->grids[n];
    const uint32_t* const numbers = batch.attributes.data() + n;
    if (content_->attributes[n] == Attribute::kColor) {
      FillGrid(batch.bricks, numbers, count, ToColor, static_cast<openvdb::Vec3SGrid&>(grid));
    } else {
      const auto value = [](uint32_t number) { return static_cast<int32_t>(number); };
      FillGrid(batch.bricks, numbers, count, value, static_cast<openvdb::Int32Grid&>(grid));
    }
  }
  return content_->voxels.Add(batch);
} catch (const std::bad_alloc&) {
  return absl::ResourceExhaustedError("not enough memory for the OpenVDB grids");
}

void AttributeGrids::SetRequest(const VoxelizeRequest& request, const MeshNote& note) {
  content_->voxels.SetRequest(request, note);
  for (const openvdb::GridBase::Ptr& grid : content_->grids) DescribeRequest(request, note, *grid);
}

void AttributeGrids::SetNames(const CarriedNames& names) {
  for (const Attribute attribute : content_->attributes) {
    DescribeNames(names, attribute, *content_->voxels.content().grid);
    for (const openvdb::GridBase::Ptr& grid : content_->grids) DescribeNames(names, attribute, *grid);
  }
}

void AttributeGrids::SetCertificate(const Certificate& certificate) {
  content_->voxels.SetCertificate(certificate);
  for (const openvdb::GridBase::Ptr& grid : content_->grids) Describe(certificate, *grid);
}

void AttributeGrids::SetWarnings(const std::vector<Warning>& warnings) {
  content_->voxels.SetWarnings(warnings);
  for (const openvdb::GridBase::Ptr& grid : content_->grids) DescribeWarnings(warnings, *grid);
}

absl::Status AttributeGrids::Write(const std::string& path) {
  openvdb::GridCPtrVec grids{content_->voxels.content().grid};
  grids.insert(grids.end(), content_->grids.begin(), content_->grids.end());
  return WriteGridFile(grids, path);
}

}  // namespace latvox::client
