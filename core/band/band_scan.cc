#include "core/band/band_scan.h"

#include <algorithm>
#include <cmath>

#include "core/digitize/cut_triangle.h"

namespace latvox {
namespace {

constexpr size_t kTileVoxels = size_t{kTileSide} * kTileSide * kTileSide;

IndexBox Overlap(IndexBox a, const IndexBox& b) {
  for (size_t m = 0; m < 3; ++m) {
    a.min[m] = std::max(a.min[m], b.min[m]);
    a.max[m] = std::min(a.max[m], b.max[m]);
  }
  return a;
}

// The voxels within the margin of a triangle's bounding box.
IndexBox VoxelsAround(const Triangle& triangle, const Vec3i& margin) {
  IndexBox box;
  for (size_t m = 0; m < 3; ++m) {
    const auto [low, high] = std::minmax({triangle[0][m], triangle[1][m], triangle[2][m]});
    box.min[m] = ((low - margin[m] - 1) >> kSubvoxelBits) + 1;
    box.max[m] = ((high + margin[m]) >> kSubvoxelBits) + 1;
  }
  return box;
}

}  // namespace

// What bounds distances to a triangle from below, along the rows of a box. In Cartesian coordinates around the centre
// of its circle, a point at x is h over the plane and at least sqrt(|x|^2 - h^2) - radius beside the triangle. With q =
// best - h^2, it is nearer than the best only if q > 0 and |x|^2 < radius^2 + 2 radius sqrt(q) + best.
struct BandScan::Rows {
  double radius_square;
  double slack;  // what these may be wrong by, for rounding, and far more
  double width;  // of the band, and more, units
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
  const IndexBox tile = Overlap({tile_min_, tile_min_ + Vec3i{kTileSide, kTileSide, kTileSide}}, context.region);
  for (const uint32_t t : triangles) {
    if (context.cancelled) return {};
    const auto& [a, b, c] = context.mesh.triangles[t];
    const Triangle triangle{context.mesh.vertices_lat[a], context.mesh.vertices_lat[b], context.mesh.vertices_lat[c]};
    const IndexBox box = Overlap(VoxelsAround(triangle, context.plan.margin), tile);
    if (box.min[0] < box.max[0] && box.min[1] < box.max[1] && box.min[2] < box.max[2]) Add(context, triangle, box);
  }
  if (context.inside) {
    const bool corner = context.inside->IsInside(tile_min_);
    FindInside(context.mesh, triangles, tile_min_, corner, context.cancelled, inside_);
  }
  TileBricks out{tile_ijk + Shifted(context.mesh.base_ijk, kTileBits), {}};
  for (int32_t n = 0; n < 512; ++n) {
    const Vec3i corner = tile_min_ + Vec3i{n >> 6, n >> 3 & 7, n & 7} * kBrickSide;
    const Brick brick = CutOut(corner, context, context.inside.has_value(), out.values);
    if (CountVoxels(brick.mask) != 0) out.bricks.push_back(brick);
  }
  out.voxels = out.values.size();
  return out;
}

// `box`: where to look, within the tile. Of a triangle that is longer than the band is wide, what is near to a plane of
// voxels, and to a row, says where.
void BandScan::Add(const BandContext& context, const Triangle& corners, const IndexBox& box) {
  const TriangleDistance triangle(context.plan.metric, corners);
  const Vec3d step = context.plan.metric.root[2] * double{kLatticeUnit};
  const double far = triangle.radius() + std::sqrt(high_);
  const double slack = 0x1p-30 * far * far;
  const Rows rows{triangle.radius() * triangle.radius(), slack, std::sqrt(high_ + slack), step, Dot(step, step),
                  Dot(step, triangle.unit_normal())};
  const CutTriangle whole(corners);
  const Vec3i& margin = context.plan.margin;
  const auto is_long = [&](size_t axis) { return (box.max[axis] - box.min[axis]) * kLatticeUnit > 4 * margin[axis]; };
  const bool is_long_i = is_long(0), is_long_j = is_long(1);
  // Of the box on an axis, what is within the margin of some part.
  struct Span {
    int32_t first, end;
  };
  const auto near = [&](const CutTriangle& part, size_t axis) {
    const auto [low, high] = part.Along(axis);
    const double first = std::ceil((low - margin[axis]) / kLatticeUnit);
    const double end = std::floor((high + margin[axis]) / kLatticeUnit) + 1;
    const auto clamped = [&](double x) {
      return static_cast<int32_t>(std::clamp<double>(x, box.min[axis], box.max[axis]));
    };
    return Span{clamped(first), clamped(end)};
  };
  const auto cut = [&](const CutTriangle& part, size_t axis, int32_t at) {
    const double middle = static_cast<double>(at) * kLatticeUnit;
    return part.Between(axis, middle - margin[axis], middle + margin[axis]);
  };
  for (int32_t i = box.min[0]; i < box.max[0] && !context.cancelled; ++i) {
    const CutTriangle plane = is_long_i ? cut(whole, 0, i) : whole;
    const Span js = is_long_i ? near(plane, 1) : Span{box.min[1], box.max[1]};
    Span ks = is_long_i ? near(plane, 2) : Span{box.min[2], box.max[2]};
    for (int32_t j = js.first; j < js.end; ++j) {
      if (is_long_j) ks = near(cut(plane, 1, j), 2);
      if (ks.first < ks.end) ScanRow(context, triangle, rows, {i, j, ks.first}, ks.end);
    }
  }
}

// From ijk up to k = end.
void BandScan::ScanRow(const BandContext& context, const TriangleDistance& triangle, const Rows& rows, const Vec3i& ijk,
                       int32_t end) {
  const Vec3i d = ijk * kLatticeUnit - triangle.corner();
  const Vec3d x = Apply(context.plan.metric.root, ToDouble(d)) - triangle.centre();
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

// Appends the values of the brick's voxels.
Brick BandScan::CutOut(const Vec3i& corner, const BandContext& context, bool is_signed,
                       std::vector<float>& values) const {
  Brick brick{Shifted(corner + context.mesh.base_ijk, kBrickBits), {}};
  const auto width = static_cast<float>(context.plan.width);
  for (int32_t x = 0; x < kBrickSide; ++x) {
    for (int32_t y = 0; y < kBrickSide; ++y) {
      const Vec3i ijk = corner + Vec3i{x, y, 0};
      const size_t first = NumberOf(ijk);
      const uint64_t inside = is_signed ? inside_[first >> kTileBits] >> (first & (kTileSide - 1)) : 0;
      for (size_t z = 0; z < kBrickSide; ++z) {
        const double square = best_[first + z];
        if (square >= high_) continue;
        brick.mask[static_cast<size_t>(x)] |= uint64_t{1} << (static_cast<size_t>(y) << kBrickBits | z);
        const float value = std::min(static_cast<float>(std::sqrt(square) * context.plan.unit), width);
        values.push_back((inside >> z & 1) != 0 && value != 0 ? -value : value);
      }
    }
  }
  return brick;
}

}  // namespace latvox
