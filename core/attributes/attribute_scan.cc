#include "core/attributes/attribute_scan.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "core/supercover/cut_triangle.h"

namespace latvox {
namespace {

constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();
// Squares with a larger relative difference certainly belong to different distances.
constexpr double kDoubt = 4 * kSquareError;

Triangle CornersOf(const SnappedMesh& mesh, uint32_t number) {
  const auto& [a, b, c] = mesh.triangles[number];
  return {mesh.vertices_lat[a], mesh.vertices_lat[b], mesh.vertices_lat[c]};
}

// Bits first to last - 1 of a row.
uint64_t BitsBetween(int32_t first, int32_t last) { return ~uint64_t{0} >> (kTileSide - (last - first)) << first; }

// Returns whether a triangle may come within sqrt(square) of x, which is relative to its center: see BandScan::Rows.
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
  for (const uint32_t number : triangles) {
    if (context.stop.Stopped()) return;
    Add(context, number);
    if (offers_.size() > kMostOffers) Settle(context);
  }
  CutOut(context, tile);
}

// Numbers voxels along the rows.
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
  least_.assign(count, most);
  last_.assign(count, kNone);
  offers_.clear();
  settled_.clear();
}

// `at`: a voxel, within the tile.
size_t AttributeScan::NumberOf(const Vec3i& at) const {
  const auto row = static_cast<size_t>(at[0] << kTileBits | at[1]);
  return first_[row] + static_cast<size_t>(std::popcount(rows_[row] & ((uint64_t{1} << at[2]) - 1)));
}

void AttributeScan::Add(const AttributeContext& context, uint32_t number) {
  const Triangle corners = CornersOf(context.mesh, number);
  const Vec3i& margin = context.carried.plan.margin;
  const IndexBox box = VoxelsNear(corners, margin, {tile_min_, tile_min_ + Vec3i{kTileSide, kTileSide, kTileSide}});
  const Metric& metric = context.carried.plan.metric;
  std::optional<TriangleDistance> triangle;  // once there is a voxel
  double slack = 0;                          // a bound on the rounding error of squares, and far more
  ForEachRowNear(corners, margin, box, [&](int32_t i, int32_t j, int32_t first, int32_t end) {
    const Vec3i from = Vec3i{i, j, first} - tile_min_;
    uint64_t bits = rows_[static_cast<size_t>(from[0] << kTileBits | from[1])];
    bits &= BitsBetween(from[2], from[2] + end - first);
    if (bits == 0) return;
    if (!triangle) {
      triangle.emplace(metric, corners);
      const double far = triangle->radius() + std::sqrt(context.carried.plan.most);
      slack = 0x1p-30 * far * far;
    }
    for (; bits != 0; bits &= bits - 1) {
      const Vec3i at{from[0], from[1], std::countr_zero(bits)};
      const size_t voxel = NumberOf(at);
      const Vec3i point = (tile_min_ + at) * kLatticeUnit;
      const Vec3d x = Apply(metric.root, ToDouble(point - triangle->corner())) - triangle->center();
      if (!MayComeWithin(*triangle, x, least_[voxel] + slack)) continue;
      Compare(*triangle, number, point, voxel);
    }
  });
}

void AttributeScan::Compare(const TriangleDistance& triangle, uint32_t number, const Vec3i& point, size_t voxel) {
  const double square = triangle.SquareTo(point);
  double& least = least_[voxel];
  if (square > least * (1 + kDoubt)) return;
  least = std::min(least, square);
  offers_.push_back({square, number, last_[voxel]});
  last_[voxel] = static_cast<uint32_t>(offers_.size() - 1);
}

// Many triangles in one place would fill the memory with offers. The nearest of the current offers replaces them.
void AttributeScan::Settle(const AttributeContext& context) {
  settled_.resize(least_.size(), {kNone, {}});
  size_t voxel = 0;
  for (int32_t row = 0; row < static_cast<int32_t>(kRows); ++row) {
    for (uint64_t bits = rows_[static_cast<size_t>(row)]; bits != 0; bits &= bits - 1, ++voxel) {
      if (context.stop.Stopped()) return;
      if (last_[voxel] == kNone) continue;
      const Vec3i at{row >> kTileBits, row & (kTileSide - 1), std::countr_zero(bits)};
      settled_[voxel] = Nearest(context, (tile_min_ + at) * kLatticeUnit, voxel);
      last_[voxel] = kNone;
    }
  }
  offers_.clear();
}

// Calls f(candidate) for all triangles that may be the nearest to a voxel.
template <class F>
void AttributeScan::ForEachCandidate(const AttributeContext& context, const Vec3i& point, size_t voxel, F&& f) const {
  if (!settled_.empty() && settled_[voxel].triangle != kNone) f(settled_[voxel]);
  for (uint32_t n = last_[voxel]; n != kNone; n = offers_[n].before) {
    if (offers_[n].square > least_[voxel] * (1 + kDoubt)) continue;
    f(Candidate{offers_[n].triangle, NearestCorner(context, offers_[n].triangle, point)});
  }
}

// Which triangle is nearest matters only if their values differ. Mostly they have the same values, because they are
// neighbors with a common corner or edge.
AttributeScan::Corner AttributeScan::Decide(const AttributeContext& context, const Vec3i& point, size_t voxel) const {
  std::optional<Corner> first;
  bool agree = true;
  ForEachCandidate(context, point, voxel, [&](const Candidate& candidate) {
    if (!first) first = candidate.corner;
    agree &= candidate.corner.values == first->values;
  });
  assert(first);  // no voxel is farther from the mesh than the plan says
  return agree ? *first : Nearest(context, point, voxel).corner;
}

AttributeScan::Corner AttributeScan::NearestCorner(const AttributeContext& context, uint32_t number,
                                                   const Vec3i& point) {
  Corner nearest{-1, {}};
  for (const uint32_t vertex : context.mesh.triangles[number]) {
    const Vec3i d = point - context.mesh.vertices_lat[vertex];
    const __int128 square = Inner(context.carried.plan.metric, d, d);
    if (nearest.square >= 0 && square > nearest.square) continue;
    const uint32_t* const offered = &context.carried.of_vertices[size_t{vertex} * context.carried.count];
    const bool first = nearest.square < 0 || square < nearest.square;
    for (uint32_t n = 0; n < context.carried.count; ++n) {
      nearest.values[n] = first ? offered[n] : std::min(nearest.values[n], offered[n]);
    }
    nearest.square = square;
  }
  return nearest;
}

// Compares exactly, and combines the nearest corners of all triangles at the same distance. Copies of a triangle are at
// the same distance without a comparison.
AttributeScan::Candidate AttributeScan::Nearest(const AttributeContext& context, const Vec3i& point,
                                                size_t voxel) const {
  const auto compare = [&](const Candidate& a, const Candidate& b) {
    const Triangle corners_a = CornersOf(context.mesh, a.triangle), corners_b = CornersOf(context.mesh, b.triangle);
    if (std::is_permutation(corners_a.begin(), corners_a.end(), corners_b.begin())) return 0;
    const Metric& metric = context.carried.plan.metric;
    return TriangleDistance::Compare(TriangleDistance(metric, corners_a), TriangleDistance(metric, corners_b), point);
  };
  std::optional<Candidate> nearest;
  ForEachCandidate(context, point, voxel, [&](const Candidate& other) {
    if (nearest && context.stop.Stopped()) return;
    const int order = nearest ? compare(other, *nearest) : -1;
    if (order < 0 || (order == 0 && other.corner.square < nearest->corner.square)) {
      nearest = other;
    } else if (order == 0 && other.corner.square == nearest->corner.square) {
      for (size_t n = 0; n < kMaxAttributes; ++n) {
        nearest->corner.values[n] = std::min(nearest->corner.values[n], other.corner.values[n]);
      }
    }
  });
  return *nearest;
}

// In the order of bricks.
void AttributeScan::CutOut(const AttributeContext& context, TileBricks& tile) {
  tile.attributes.clear();
  tile.attributes.reserve(least_.size() * context.carried.count);
  for (const Brick& brick : tile.bricks) {
    const Vec3i corner = (brick.brick_ijk - tile.tile_ijk * kBrickSide) * kBrickSide;
    for (int32_t x = 0; x < kBrickSide; ++x) {
      if (context.stop.Stopped()) return;
      for (uint64_t bits = brick.mask[static_cast<size_t>(x)]; bits != 0; bits &= bits - 1) {
        const int yz = std::countr_zero(bits);
        const Vec3i at = corner + Vec3i{x, yz >> kBrickBits, yz & (kBrickSide - 1)};
        const Corner found = Decide(context, (tile_min_ + at) * kLatticeUnit, NumberOf(at));
        const auto end = found.values.begin() + context.carried.count;
        tile.attributes.insert(tile.attributes.end(), found.values.begin(), end);
      }
    }
  }
}

}  // namespace latvox
