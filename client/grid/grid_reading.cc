#include "client/grid/grid_reading.h"

#include <cmath>

#include "client/grid/openvdb_metadata.h"
#include "client/internal/voxel_size.h"

namespace latvox::client {
namespace {

GridTransform FromTransform(const openvdb::math::Transform& transform) {
  const openvdb::Mat4d m = transform.baseMap()->getAffineMap()->getMat4();
  GridTransform out;
  out.basis = {{m[0][0], m[0][1], m[0][2]}, {m[1][0], m[1][1], m[1][2]}, {m[2][0], m[2][1], m[2][2]}};
  out.origin = {m[3][0], m[3][1], m[3][2]};
  out.voxel_size = VoxelSizeOf(out.basis);
  return out;
}

bool IsFinite(const GridTransform& transform) {
  double sum = transform.voxel_size;
  for (const Vec3d& v : {transform.basis.a, transform.basis.b, transform.basis.c, transform.origin}) {
    for (const double x : v) sum += std::abs(x);
  }
  return std::isfinite(sum);
}

}  // namespace

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

bool IsAffine(const openvdb::math::Transform& transform) {
  return transform.isLinear() && IsFinite(FromTransform(transform));
}

absl::Status CheckTransform(const openvdb::GridBase& grid, const std::string& path) {
  if (IsAffine(grid.transform())) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(path, ": the grid's transform is not affine and finite"));
}

}  // namespace latvox::client
