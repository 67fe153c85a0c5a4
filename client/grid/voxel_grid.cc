#include "client/grid/voxel_grid.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <new>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "client/error.h"
#include "client/grid/grid_file.h"
#include "client/grid/grid_metadata.h"
#include "client/grid/nano_file.h"
#include "client/grid/openvdb_grid.h"
#include "client/grid/request_metadata.h"
#include "client/grid/tree_nodes.h"

namespace latvox::client {
namespace {

GridTransform FromTransform(const openvdb::math::Transform& transform) {
  const openvdb::Mat4d m = transform.baseMap()->getAffineMap()->getMat4();
  GridTransform out;
  out.basis = {{m[0][0], m[0][1], m[0][2]}, {m[1][0], m[1][1], m[1][2]}, {m[2][0], m[2][1], m[2][2]}};
  out.origin = {m[3][0], m[3][1], m[3][2]};
  out.voxel_size = std::cbrt(std::abs(m.getMat3().det()));
  return out;
}

// What read(file) returns of the file, opened without its voxels.
template <class Read>
auto WithFile(const std::string& path, const Read& read) -> decltype(read(std::declval<openvdb::io::File&>())) try {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return absl::NotFoundError(absl::StrCat(path, ": no such file"));
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open(/*delayLoad=*/false);
  return read(file);
} catch (const std::exception& error) {
  return absl::InvalidArgumentError(absl::StrCat(path, ": is not a readable .vdb file (", error.what(), ")"));
}

GridFileInfo Describe(const openvdb::GridBase& grid) {
  GridFileInfo info;
  info.name = grid.getName();
  info.value_type = grid.valueType();
  info.transform = FromTransform(grid.transform());
  info.active_voxels = grid.activeVoxelCount();
  if (info.active_voxels > 0) {
    const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    const openvdb::Coord end = box.max().offsetBy(1);
    info.active_box = IndexBox{{box.min()[0], box.min()[1], box.min()[2]}, {end[0], end[1], end[2]}};
  }
  for (auto meta = grid.beginMeta(); meta != grid.endMeta(); ++meta) {
    if (meta->second) info.metadata.emplace_back(meta->first, MetadataText(*meta->second));
  }
  return info;
}

bool IsFinite(const GridTransform& transform) {
  double sum = transform.voxel_size;
  for (const Vec3d& v : {transform.basis.a, transform.basis.b, transform.basis.c, transform.origin}) {
    for (const double x : v) sum += std::abs(x);
  }
  return std::isfinite(sum);
}

absl::StatusOr<GridFile> Content(const openvdb::GridBase::Ptr& first, const std::string& path) {
  const auto grid = openvdb::gridPtrCast<openvdb::BoolGrid>(first);
  if (!grid) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": the grid \"", first->getName(), "\" is a ", first->type(),
                                                   ", not a ", openvdb::BoolGrid::gridType()));
  }
  if (const auto tiles = grid->tree().activeTileCount(); tiles > 0) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": has ", tiles, " active tiles, not voxels alone"));
  }
  if (!grid->transform().isLinear() || !IsFinite(FromTransform(grid->transform()))) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": the grid's transform is not affine and finite"));
  }
  GridFile file{Describe(*grid), {}};
  file.bricks.reserve(grid->tree().leafCount());
  for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf) {
    if (!leaf->isEmpty()) file.bricks.push_back(ToBrick(*leaf));
  }
  std::sort(file.bricks.begin(), file.bricks.end(),
            [](const Brick& a, const Brick& b) { return a.brick_ijk < b.brick_ijk; });
  return file;
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
  openvdb::tree::ValueAccessor<openvdb::BoolTree> tree(content_->grid->tree());
  for (const Brick& brick : batch.bricks) {
    const openvdb::Coord corner(brick.brick_ijk[0] * 8, brick.brick_ijk[1] * 8, brick.brick_ijk[2] * 8);
    AddMask(brick.mask, *tree.touchLeaf(corner));
  }
  return absl::OkStatus();
} catch (const std::bad_alloc&) {
  return absl::ResourceExhaustedError("not enough memory for the OpenVDB grid");
}

void VoxelGrid::SetRequest(const VoxelizeRequest& request) { DescribeRequest(request, *content_->grid); }

void VoxelGrid::SetCertificate(const Certificate& certificate) { Describe(certificate, *content_->grid); }

uint64_t VoxelGrid::CountActiveVoxels() const { return content_->grid->activeVoxelCount(); }

absl::Status VoxelGrid::Write(const std::string& path) const { return WriteGridFile({content_->grid}, path); }

absl::Status VoxelGrid::WriteNano(const std::string& path) const { return WriteNanoFile(*content_->grid, path); }

absl::StatusOr<GridFileInfo> ReadGridFileInfo(const std::string& path) {
  return WithFile(path, [&](openvdb::io::File& file) -> absl::StatusOr<GridFileInfo> {
    const openvdb::GridPtrVecPtr grids = file.getGrids();
    if (!grids || grids->empty()) return absl::InvalidArgumentError(absl::StrCat(path, ": holds no grid"));
    // Others may stand before it, by their names.
    const auto is_set = [](const openvdb::GridBase::Ptr& grid) { return grid->getName() == "voxels"; };
    const auto set = std::find_if(grids->begin(), grids->end(), is_set);
    const openvdb::GridBase& grid = set == grids->end() ? *grids->front() : **set;
    if (!grid.transform().isLinear()) {
      return absl::InvalidArgumentError(absl::StrCat(path, ": the grid's transform is not affine"));
    }
    return Describe(grid);
  });
}

absl::StatusOr<GridFile> ReadGridFile(const std::string& path) {
  return WithFile(path, [&](openvdb::io::File& file) -> absl::StatusOr<GridFile> {
    const auto name = file.beginName();
    if (name == file.endName()) return absl::InvalidArgumentError(absl::StrCat(path, ": holds no grid"));
    return Content(file.readGrid(file.hasGrid("voxels") ? "voxels" : *name), path);
  });
}

absl::StatusOr<std::string> ReadGridFileDigest(const std::string& path) {
  return WithFile(path, [&](openvdb::io::File& file) -> absl::StatusOr<std::string> {
    const openvdb::GridPtrVecPtr grids = file.readAllGridMetadata();
    if (!grids || grids->empty()) return absl::InvalidArgumentError(absl::StrCat(path, ": holds no grid"));
    const openvdb::Metadata::Ptr digest = (*grids->front())["latvox_digest"];
    return digest ? digest->str() : "";
  });
}

}  // namespace latvox::client
