#include "core/band/band_scan.h"

#include <algorithm>
#include <cmath>

#include "core/supercover/cut_triangle.h"

namespace latvox {
namespace {

constexpr size_t kTileVoxels = size_t{kTileSide} * kTileSide * kTileSide;

}  // namespace

// Lower bounds of the distances to a triangle, along the rows of a box. In Cartesian coordinates around the center of
// its circle, a point x lies at the height h over the plane, and at least sqrt(|x|^2 - h^2) - radius beside the
// triangle. With q = best - h^2, it is nearer than the best only if q > 0 and |x|^2 < radius^2 + 2 radius sqrt(q) +
// best.
struct BandScan::Rows {
  double radius_square;
  double slack;  // a bound on the rounding error of these, and far more
  double width;  // of the band, and more, in units
  Vec3d step;    // along k
  double step_square, step_height;
};

BandScan::BandScan() : best_(kTileVoxels) {}

size_t BandScan::NumberOf(const Vec3i& ijk) const {
  const Vec3i at = ijk - tile_min_;
  return static_cast<size_t>((at[0] << kTileBits | at[1]) << kTileBits | at[2]);
}

TileBricks BandScan::Scan(const BandContext& context, const Vec3i& tile_ijk, std::span<const uint32_t> triangles) {
  tile_min_ = tile_ijk * kTileSide;
  const double limit = static_cast<double>(context.plan.limit) / context.plan.metric.one;  // units
  low_ = limit * (1 - 2 * kSquareError);
  high_ = limit * (1 + 2 * kSquareError);
  std::fill(best_.begin(), best_.end(), high_);
  const IndexBox tile = Intersection({tile_min_, tile_min_ + Vec3i{kTileSide, kTileSide, kTileSide}}, context.region);
  for (const uint32_t t : triangles) {
    if (context.stop.Stopped()) return {};
    const auto& [a, b, c] = context.mesh.triangles[t];
    const Triangle triangle{context.mesh.vertices_lat[a], context.mesh.vertices_lat[b], context.mesh.vertices_lat[c]};
    const IndexBox box = VoxelsNear(triangle, context.plan.margin, tile);
    if (!IsEmpty(box)) Add(context, triangle, box);
  }
  TileBricks out{tile_ijk + Shifted(context.mesh.base_ijk, kTileBits), {}};
  for (int32_t n = 0; n < 512; ++n) {
    const Vec3i corner = tile_min_ + Vec3i{n >> 6, n >> 3 & 7, n & 7} * kBrickSide;
    const Brick brick = CutOut(corner, context, out.squares);
    if (CountVoxels(brick.mask) != 0) out.bricks.push_back(brick);
  }
  out.voxels = out.squares.size();
  return out;
}

// `box`: VoxelsNear of the triangle.
void BandScan::Add(const BandContext& context, const Triangle& corners, const IndexBox& box) {
  const TriangleDistance triangle(context.plan.metric, corners);
  const Vec3d step = context.plan.metric.root[2] * double{kLatticeUnit};
  const double far = triangle.radius() + std::sqrt(high_);
  const double slack = 0x1p-30 * far * far;
  const Rows rows{triangle.radius() * triangle.radius(), slack, std::sqrt(high_ + slack), step, Dot(step, step),
                  Dot(step, triangle.unit_normal())};
  ForEachRowNear(corners, context.plan.margin, box, [&](int32_t i, int32_t j, int32_t first, int32_t end) {
    if (!context.stop.Stopped()) ScanRow(context, triangle, rows, {i, j, first}, end);
  });
}

// Scans from ijk up to k = end.
void BandScan::ScanRow(const BandContext& context, const TriangleDistance& triangle, const Rows& rows, const Vec3i& ijk,
                       int32_t end) {
  const Vec3i d = ijk * kLatticeUnit - triangle.corner();
  const Vec3d x = Apply(context.plan.metric.root, ToDouble(d)) - triangle.center();
  const double square = Dot(x, x), slope = 2 * Dot(x, rows.step), height = Dot(x, triangle.unit_normal());
  int32_t first = 0, last = end - ijk[2] - 1;
  if (std::abs(rows.step_height) * last > rows.width) {  // only where the plane is near enough
    const double middle = -height / rows.step_height, half = rows.width / std::abs(rows.step_height);
    first = static_cast<int32_t>(std::clamp(std::floor(middle - half), 0.0, double{kTileSide}));
    last = static_cast<int32_t>(std::clamp(std::ceil(middle + half), -1.0, double(last)));
  } else if (std::abs(height) > 2 * rows.width) {
    return;
  }
  double* const best = &best_[NumberOf(ijk)];
  for (int32_t k = first; k <= last; ++k) {
    const double h = height + k * rows.step_height, least = best[k] + rows.slack;
    const double q = least - h * h;
    const double beyond = square + k * (slope + k * rows.step_square) - rows.radius_square - least;
    if (q < 0 || (beyond > 0 && beyond * beyond > 4 * rows.radius_square * q)) continue;
    Offer(context, triangle, ijk + Vec3i{0, 0, k}, best[k]);
  }
}

void BandScan::Offer(const BandContext& context, const TriangleDistance& triangle, const Vec3i& ijk,
                     double& best) const {
  const Vec3i point = ijk * kLatticeUnit;
  const double square = triangle.SquareTo(point);
  if (square >= best || (square > low_ && !triangle.IsWithin(point, context.plan.limit))) return;
  best = square;
}

// Appends the squares of the brick's voxels.
Brick BandScan::CutOut(const Vec3i& corner, const BandContext& context, std::vector<double>& squares) const {
  Brick brick{Shifted(corner + context.mesh.base_ijk, kBrickBits), {}};
  for (int32_t x = 0; x < kBrickSide; ++x) {
    for (int32_t y = 0; y < kBrickSide; ++y) {
      const size_t first = NumberOf(corner + Vec3i{x, y, 0});
      for (size_t z = 0; z < kBrickSide; ++z) {
        const double square = best_[first + z];
        if (square >= high_) continue;
        brick.mask[static_cast<size_t>(x)] |= uint64_t{1} << (static_cast<size_t>(y) << kBrickBits | z);
        squares.push_back(square);
      }
    }
  }
  return brick;
}

}  // namespace latvox
