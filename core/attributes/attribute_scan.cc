#include "core/attributes/attribute_scan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

namespace latvox {
namespace {

constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();
constexpr auto kFarthest = static_cast<__int128>(~static_cast<unsigned __int128>(0) >> 1);

Triangle CornersOf(const SnappedMesh& mesh, uint32_t number) {
  const auto& [a, b, c] = mesh.triangles[number];
  return {mesh.vertices_lat[a], mesh.vertices_lat[b], mesh.vertices_lat[c]};
}

// Bits first to last - 1 of a row.
uint64_t BitsBetween(int32_t first, int32_t last) { return ~uint64_t{0} >> (kTileSide - (last - first)) << first; }

// Whether a triangle may come within sqrt(square) of x, which is relative to its centre: see BandScan::Rows.
bool MayComeWithin(const TriangleDistance& triangle, const Vec3d& x, double square) {
  const double height = Dot(x, triangle.unit_normal()), q = square - height * height;
  if (q < 0) return false;
  const double radius_square = triangle.radius() * triangle.radius();
  const double beyond = Dot(x, x) - radius_square - square;
  return !(beyond > 0 && beyond * beyond > 4 * radius_square * q);
}

}  // namespace

void AttributeScan::Find(const AttributeContext& context, std::span<const uint32_t> triangles, TileBricks& tile) {
  Number(tile, context.mesh.base_ijk, context.carried.plan.most);
  values_.assign(nearest_.size() * context.carried.count, 0);
  for (const uint32_t number : triangles) {
    if (context.cancelled) return;
    Add(context, number);
  }
  CutOut(context.carried.count, tile);
}

// Voxels have numbers along the rows.
void AttributeScan::Number(const TileBricks& tile, const Vec3i& base_ijk, double most) {
  tile_min_ = tile.tile_ijk * kTileSide - base_ijk;
  rows_.fill(0);
  for (const Brick& brick : tile.bricks) {
    const Vec3i at = brick.brick_ijk * kBrickSide - tile.tile_ijk * kTileSide;
    for (int32_t x = 0; x < kBrickSide; ++x) {
      for (int32_t y = 0; y < kBrickSide; ++y) {
        const uint64_t bits = brick.mask[static_cast<size_t>(x)] >> (y << kBrickBits) & 0xFF;
        rows_[static_cast<size_t>((at[0] + x) << kTileBits | (at[1] + y))] |= bits << at[2];
      }
    }
  }
  uint32_t count = 0;
  for (size_t row = 0; row < kRows; ++row) {
    first_[row] = count;
    count += static_cast<uint32_t>(std::popcount(rows_[row]));
  }
  nearest_.assign(count, Nearest{most, 0, kNone});
}

void AttributeScan::Add(const AttributeContext& context, uint32_t number) {
  const Triangle corners = CornersOf(context.mesh, number);
  Vec3i low, high;  // voxels of the tile, within the margin of the triangle's bounding box
  for (size_t m = 0; m < 3; ++m) {
    const auto [least, most] = std::minmax({corners[0][m], corners[1][m], corners[2][m]});
    low[m] = std::max(((least - context.carried.plan.margin[m] - 1) >> kSubvoxelBits) + 1 - tile_min_[m], 0);
    high[m] = std::min(((most + context.carried.plan.margin[m]) >> kSubvoxelBits) + 1 - tile_min_[m], kTileSide);
    if (low[m] >= high[m]) return;
  }
  const Metric& metric = context.carried.plan.metric;
  const uint64_t between = BitsBetween(low[2], high[2]);
  std::optional<TriangleDistance> triangle;  // once there is a voxel
  double slack = 0;                          // what squares may be wrong by, for rounding, and far more
  for (int32_t i = low[0]; i < high[0]; ++i) {
    for (int32_t j = low[1]; j < high[1]; ++j) {
      const auto row = static_cast<size_t>(i << kTileBits | j);
      uint64_t bits = rows_[row] & between;
      if (bits == 0) continue;
      if (!triangle) {
        triangle.emplace(metric, corners);
        const double far = triangle->radius() + std::sqrt(context.carried.plan.most);
        slack = 0x1p-30 * far * far;
      }
      for (; bits != 0; bits &= bits - 1) {
        const int k = std::countr_zero(bits);
        const size_t voxel = first_[row] + static_cast<size_t>(std::popcount(rows_[row] & ((uint64_t{1} << k) - 1)));
        const Vec3i point = (tile_min_ + Vec3i{i, j, k}) * kLatticeUnit;
        const Vec3d x = Apply(metric.root, ToDouble(point - triangle->corner())) - triangle->centre();
        if (!MayComeWithin(*triangle, x, nearest_[voxel].square + slack)) continue;
        Offer(context, number, *triangle, point, voxel);
      }
    }
  }
}

// Doubles decide, but where two squares are about the same.
void AttributeScan::Offer(const AttributeContext& context, uint32_t number, const TriangleDistance& triangle,
                          const Vec3i& point, size_t voxel) {
  constexpr double kSure = 4 * kSquareError;
  Nearest& nearest = nearest_[voxel];
  const double square = triangle.SquareTo(point);
  if (square > nearest.square * (1 + kSure)) return;
  int order = -1;
  if (nearest.triangle != kNone && square >= nearest.square * (1 - kSure)) {
    const TriangleDistance other(context.carried.plan.metric, CornersOf(context.mesh, nearest.triangle));
    order = square == 0 ? 0 : TriangleDistance::Compare(triangle, other, point);
  }
  if (order > 0) return;
  if (order < 0) nearest = {square, kFarthest, number};
  OfferCorners(context, number, point, voxel);
}

void AttributeScan::OfferCorners(const AttributeContext& context, uint32_t number, const Vec3i& point, size_t voxel) {
  __int128& least = nearest_[voxel].corner_square;
  uint32_t* const values = &values_[voxel * context.carried.count];
  for (const uint32_t vertex : context.mesh.triangles[number]) {
    const Vec3i d = point - context.mesh.vertices_lat[vertex];
    const __int128 square = Inner(context.carried.plan.metric, d, d);
    if (square > least) continue;
    const uint32_t* const offered = &context.carried.of_vertices[size_t{vertex} * context.carried.count];
    for (uint32_t n = 0; n < context.carried.count; ++n) {
      values[n] = square < least ? offered[n] : std::min(values[n], offered[n]);
    }
    least = square;
  }
}

// From the order of rows to that of bricks.
void AttributeScan::CutOut(uint32_t count, TileBricks& tile) const {
  tile.attributes.clear();
  tile.attributes.reserve(values_.size());
  for (const Brick& brick : tile.bricks) {
    const Vec3i at = brick.brick_ijk * kBrickSide - tile.tile_ijk * kTileSide;
    for (int32_t x = 0; x < kBrickSide; ++x) {
      for (int32_t y = 0; y < kBrickSide; ++y) {
        const uint64_t bits = brick.mask[static_cast<size_t>(x)] >> (y << kBrickBits) & 0xFF;
        const auto row = static_cast<size_t>((at[0] + x) << kTileBits | (at[1] + y));
        const auto before = static_cast<size_t>(std::popcount(rows_[row] & ((uint64_t{1} << at[2]) - 1)));
        const auto first = values_.begin() + static_cast<std::ptrdiff_t>((first_[row] + before) * count);
        tile.attributes.insert(tile.attributes.end(), first, first + std::popcount(bits) * std::ptrdiff_t{count});
      }
    }
  }
}

}  // namespace latvox
