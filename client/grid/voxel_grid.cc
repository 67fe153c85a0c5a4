#include "latvox/grid/voxel_grid.h"

#include <algorithm>
#include <cmath>
#include <new>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/grid/grid_file.h"
#include "client/grid/grid_metadata.h"
#include "client/grid/grid_reading.h"
#include "client/grid/grid_stream.h"
#include "client/grid/metadata_types.h"
#include "client/grid/nano_file.h"
#include "client/grid/open_file.h"
#include "client/grid/request_metadata.h"
#include "client/grid/tree_nodes.h"
#include "client/grid/warning_metadata.h"
#include "client/internal/printable.h"
#include "latvox/error.h"
#include "latvox/grid/openvdb_grid.h"

namespace latvox::client {
namespace {

absl::StatusOr<GridFile> Content(const openvdb::GridBase::Ptr& first, const std::string& path) {
  const auto grid = openvdb::gridPtrCast<openvdb::BoolGrid>(first);
  if (!grid) {
    return absl::InvalidArgumentError(
        absl::StrCat(path, ": the grid \"", Printable(first->getName()), "\" is a ", first->type(),
                     "; voxels are read from a bool grid, and distances of a band from a float grid with the name "
                     "\"distance\". Write the mask of the grid as a bool grid, or give the distances that name"));
  }
  if (auto status = CheckTransform(*grid, path); !status.ok()) return status;
  const auto leaves = SortedLeaves(grid->tree(), path);
  if (!leaves.ok()) return leaves.status();
  GridFile file{Describe(*grid), {}};
  file.bricks.reserve(leaves->size());
  for (const Leaf* leaf : *leaves) file.bricks.push_back(ToBrick(*leaf));
  return file;
}

// Returns the name of the grid that is read. Other grids may stand before it, because of their names.
absl::StatusOr<std::string> SetName(const GridArchive& archive, const std::string& path) {
  if (archive.empty()) return NoGrid(path);
  return archive.HasGrid("voxels") ? "voxels" : archive.FirstName();
}

}  // namespace

absl::Status CheckGridTransform(const GridTransform& transform) try {
  MakeTransform(transform);
  return absl::OkStatus();
} catch (const openvdb::ArithmeticError& error) {
  const std::string value = absl::StrFormat("%.6g", transform.voxel_size);
  const std::string limit = absl::StrFormat("%.6g", std::cbrt(3 * openvdb::math::Tolerance<double>::value()));
  absl::Status status =
      absl::InvalidArgumentError(absl::StrCat("voxel_size ", value, " is below ", limit,
                                              ", the least that a .vdb file's transform takes (", error.what(), ")"));
  SetErrorDetails({"VOXEL_SIZE_OUT_OF_RANGE", "voxel_size", value, limit, std::nullopt}, status);
  return status;
}

VoxelGrid::VoxelGrid(const GridTransform& transform) : content_(std::make_unique<Content>()) {
  openvdb::initialize();
  content_->grid = openvdb::BoolGrid::create(false);
  openvdb::BoolGrid& grid = *content_->grid;
  grid.setName("voxels");
  Place(transform, grid);
}

VoxelGrid::VoxelGrid(VoxelGrid&&) noexcept = default;
VoxelGrid& VoxelGrid::operator=(VoxelGrid&&) noexcept = default;
VoxelGrid::~VoxelGrid() = default;

absl::Status VoxelGrid::Add(const BrickBatch& batch) try {
  AddBricks(batch.bricks, content_->grid->tree());
  return absl::OkStatus();
} catch (const std::bad_alloc&) {
  return absl::ResourceExhaustedError("not enough memory for the OpenVDB grid");
}

void VoxelGrid::SetRequest(const VoxelizeRequest& request, const MeshNote& note) {
  DescribeRequest(request, note, *content_->grid);
}

void VoxelGrid::SetCertificate(const Certificate& certificate) { Describe(certificate, *content_->grid); }

void VoxelGrid::SetWarnings(const std::vector<Warning>& warnings) { DescribeWarnings(warnings, *content_->grid); }

void VoxelGrid::SetMetadata(const std::vector<std::pair<std::string, std::string>>& metadata) {
  InsertTexts(metadata, *content_->grid);
}

uint64_t VoxelGrid::CountActiveVoxels() const { return content_->grid->activeVoxelCount(); }

absl::Status VoxelGrid::Write(const std::string& path) const { return WriteGridFile({content_->grid}, path); }

absl::Status VoxelGrid::WriteNano(const std::string& path) const { return WriteNanoFile({content_->grid}, path); }

absl::StatusOr<GridFileInfo> ReadGridFileInfo(std::istream& in, const std::string& path) {
  return WithArchive(in, path, [&](GridArchive& archive) -> absl::StatusOr<GridFileInfo> {
    const auto name = SetName(archive, path);
    if (!name.ok()) return name.status();
    const openvdb::GridBase::Ptr grid = archive.ReadGrid(*name);
    if (!grid->transform().isLinear()) {
      return absl::InvalidArgumentError(absl::StrCat(path, ": the grid's transform is not affine"));
    }
    return Describe(*grid);
  });
}

absl::StatusOr<GridFileInfo> ReadGridFileInfo(const std::string& path) {
  auto file = OpenGridFile(path);
  if (!file.ok()) return file.status();
  return ReadGridFileInfo(*file, path);
}

absl::StatusOr<GridFile> ReadVoxels(GridArchive& archive, const std::string& path) {
  const auto name = SetName(archive, path);
  if (!name.ok()) return name.status();
  return Content(archive.ReadGrid(*name), path);
}

absl::StatusOr<GridFile> ReadGridFile(const std::string& path) {
  return WithFile(path, [&](GridArchive& archive) { return ReadVoxels(archive, path); });
}

}  // namespace latvox::client
