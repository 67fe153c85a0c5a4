#include "core/walk/walls.h"

#include <algorithm>

#include "core/supercover/cut_triangle.h"

namespace latvox {

void WallScan::Scan(const TileContext& context, const BandPlan* close, const TileNode& node) {
  FindSurface(context, node, block_);
  has_near_ = close != nullptr;
  if (!has_near_) return;
  near_.words().assign(block_.surface.voxels().where().layout.Words(), 0);
  AddNear(context, *close, node.triangles);
}

// Each decision is a function of one point and one triangle, so neither the order of triangles nor the block matters.
void WallScan::AddNear(const TileContext& context, const BandPlan& close, std::span<const uint32_t> triangles) {
  const BlockBox& where = block_.surface.voxels().where();
  const double limit = static_cast<double>(close.limit) / close.metric.one;  // units
  const double low = limit * (1 - 2 * kSquareError), high = limit * (1 + 2 * kSquareError);
  for (const uint32_t t : triangles) {
    if (context.stop.Stopped()) return;
    const Triangle corners = context.mesh.TriangleAt(t);
    const IndexBox box = VoxelsNear(corners, close.margin, where.wanted);
    if (IsEmpty(box)) continue;
    const TriangleDistance triangle(close.metric, corners);
    ForEachRowNear(corners, close.margin, box, [&](int32_t i, int32_t j, int32_t first, int32_t end) {
      if (context.stop.Stopped()) return;
      uint32_t number = where.layout.NumberOf({i, j, first});
      for (int32_t k = first; k < end; ++k, ++number) {
        if (near_.Test(number)) continue;
        const Vec3i point = Vec3i{i, j, k} * kLatticeUnit;
        const double square = triangle.SquareTo(point);
        if (square <= low || (square < high && triangle.IsWithin(point, close.limit))) near_.Set(number);
      }
    });
  }
}

bool WallScan::MayMeet(const HaloBox& box) const {
  const IndexBox& dirty = block_.surface.voxels().dirty_box();
  return has_near_ || !IsEmpty(Intersection(dirty, {box.low, box.low + box.side}));
}

void WallScan::SurfaceIn(const HaloBox& box, std::vector<WideRow>& rows) {
  const BlockVoxels& voxels = block_.surface.voxels();
  ReadRows(voxels.where().layout, voxels.bits(), box, rows);
}

void WallScan::WallsIn(const HaloBox& box, std::vector<WideRow>& rows) {
  SurfaceIn(box, rows);
  if (!has_near_) return;
  ReadRows(block_.surface.voxels().where().layout, near_, box, near_rows_);
  for (size_t n = 0; n < rows.size(); ++n) rows[n] |= near_rows_[n];
}

}  // namespace latvox
