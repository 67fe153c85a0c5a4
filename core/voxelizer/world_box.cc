#include "core/voxelizer/world_box.h"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>

namespace latvox {
namespace {

using boost::multiprecision::cpp_int;

// Returns the sign of the sum of factor[n] * x[n]. For points on a face it computes with numbers of up to 2100 bits, in
// some microseconds.
int ExactSign(const std::array<int32_t, 5>& factor, const std::array<double, 5>& x) {
  constexpr int kDigits = std::numeric_limits<double>::digits;
  std::array<int64_t, 5> mantissa{};
  std::array<int, 5> exponent{};
  int lowest = std::numeric_limits<double>::max_exponent;
  for (size_t n = 0; n < 5; ++n) {
    mantissa[n] = static_cast<int64_t>(std::ldexp(std::frexp(x[n], &exponent[n]), kDigits));
    if (mantissa[n] != 0) lowest = std::min(lowest, exponent[n]);
  }
  cpp_int sum = 0;
  for (size_t n = 0; n < 5; ++n) {
    if (mantissa[n] != 0) sum += (cpp_int(mantissa[n]) * factor[n]) << (exponent[n] - lowest);
  }
  return sum.sign();
}

// Calls f(corner) until it returns false; returns whether it never did.
template <class F>
bool AllCorners(const IndexBox& box, const F& f) {
  for (size_t corner = 0; corner < 8; ++corner) {
    Vec3i ijk;
    for (size_t m = 0; m < 3; ++m) ijk[m] = (corner >> m & 1) != 0 ? box.max[m] - 1 : box.min[m];
    if (!f(ijk)) return false;
  }
  return true;
}

}  // namespace

// Returns the sign of a point's position minus the limit, along a world axis. Seven operations round, each by 2^-53 of
// a value of at most `size`, or, where they underflow, by less than the least normal number.
int WorldBox::Compare(size_t axis, const Vec3i& ijk, double limit) const {
  const double a = basis_[0][axis], b = basis_[1][axis], c = basis_[2][axis];
  const double ia = ijk[0] * a, jb = ijk[1] * b, kc = ijk[2] * c;
  const double difference = ((origin_[axis] - limit) + ia) + (jb + kc);
  const double size = std::abs(origin_[axis]) + std::abs(limit) + std::abs(ia) + std::abs(jb) + std::abs(kc);
  const double error = 0x1p-49 * size + std::numeric_limits<double>::min();
  if (difference > error) return 1;
  if (difference < -error) return -1;
  return ExactSign({1, -1, ijk[0], ijk[1], ijk[2]}, {origin_[axis], limit, a, b, c});
}

// Returns -1 below the box, 0 within, 1 above.
int WorldBox::SideOf(size_t axis, const Vec3i& ijk) const {
  if (Compare(axis, ijk, bounds_.min[axis]) < 0) return -1;
  return Compare(axis, ijk, bounds_.max[axis]) > 0 ? 1 : 0;
}

bool WorldBox::Contains(const Vec3i& ijk) const {
  return SideOf(0, ijk) == 0 && SideOf(1, ijk) == 0 && SideOf(2, ijk) == 0;
}

bool WorldBox::ContainsAll(const IndexBox& box) const {
  return AllCorners(box, [this](const Vec3i& ijk) { return Contains(ijk); });
}

bool WorldBox::Misses(const IndexBox& box) const {
  for (size_t axis = 0; axis < 3; ++axis) {
    const int side = SideOf(axis, box.min);
    if (side != 0 && AllCorners(box, [&](const Vec3i& ijk) { return SideOf(axis, ijk) == side; })) return true;
  }
  return false;
}

// Converts the part of the world's box that the points of `box` reach, relative to the origin, to lattice coordinates.
//
// With K = |a||b||c| / |det| and R = |b||c| / |det| for i, likewise for j and k: a cofactor is wrong by at most 2^-51
// |b||c|, and the determinant by 2^-50 K of itself. So an entry of the inverse, which is at most R, is wrong by less
// than 2^-48 K R.
IndexBox WorldBox::Around(const IndexBox& box) const {
  Vec3d low, high;  // world, relative to the origin
  double reach = 0;
  for (size_t axis = 0; axis < 3; ++axis) {
    double least = 0, most = 0, size = 0;
    for (size_t m = 0; m < 3; ++m) {
      const auto [p, q] = std::minmax({basis_[m][axis] * box.min[m], basis_[m][axis] * (box.max[m] - 1)});
      least += p;
      most += q;
      size += std::max(std::abs(p), std::abs(q));
    }
    low[axis] = std::max(bounds_.min[axis] - origin_[axis], least - 0x1p-48 * size);
    high[axis] = std::min(bounds_.max[axis] - origin_[axis], most + 0x1p-48 * size);
    if (low[axis] > high[axis]) return {};
    reach += std::max(std::abs(low[axis]), std::abs(high[axis]));
  }
  const double det = std::abs(Determinant(basis_));
  const double skewness = LengthOf(basis_[0]) * LengthOf(basis_[1]) * LengthOf(basis_[2]) / det;
  IndexBox around = box;
  for (size_t m = 0; m < 3; ++m) {
    const double slack = 0x1p-44 * skewness * skewness / LengthOf(basis_[m]) * reach;
    double least = -slack, most = slack;
    for (size_t axis = 0; axis < 3; ++axis) {
      const auto [p, q] = std::minmax({inverse_[axis][m] * low[axis], inverse_[axis][m] * high[axis]});
      least += p;
      most += q;
    }
    // A comparison with a value that is not a number leaves the limit as it was.
    if (least > box.min[m]) around.min[m] = static_cast<int32_t>(std::min(std::ceil(least), double(box.max[m])));
    if (most < box.max[m] - 1) around.max[m] = static_cast<int32_t>(std::max(std::floor(most), box.min[m] - 1.0)) + 1;
    if (around.min[m] >= around.max[m]) return {};
  }
  return around;
}

void WorldBox::Clip(Brick& brick) const {
  const Vec3i low = brick.brick_ijk * kBrickSide;
  for (size_t x = 0; x < kBrickSide; ++x) {
    for (uint64_t some = brick.mask[x]; some != 0; some &= some - 1) {
      const int n = std::countr_zero(some);
      if (!Contains(low + Vec3i{static_cast<int32_t>(x), n >> kBrickBits, n & (kBrickSide - 1)})) {
        brick.mask[x] &= ~(uint64_t{1} << n);
      }
    }
  }
}

void WorldBox::Clip(TileBricks& tile) const {
  const auto cube = [](const Vec3i& corner, int32_t side) {
    return IndexBox{corner, corner + Vec3i{side, side, side}};
  };
  if (ContainsAll(cube(tile.tile_ijk * kTileSide, kTileSide))) return;
  auto from = tile.squares.begin(), to = from;
  tile.voxels = 0;
  for (Brick& brick : tile.bricks) {
    const BrickMask mask = brick.mask;
    if (!ContainsAll(cube(brick.brick_ijk * kBrickSide, kBrickSide))) Clip(brick);
    tile.voxels += CountVoxels(brick.mask);
    if (tile.squares.empty()) continue;
    for (size_t x = 0; x < kBrickSide; ++x) {
      for (uint64_t some = mask[x]; some != 0; some &= some - 1, ++from) {
        if ((brick.mask[x] & some & -some) != 0) *to++ = *from;
      }
    }
  }
  tile.squares.erase(to, tile.squares.end());
  std::erase_if(tile.bricks, [](const Brick& brick) { return CountVoxels(brick.mask) == 0; });
}

// A parallelepiped of the basis lies around each point of the box. Their union lies in a box that is wider by its
// extent.
double MostPointsIn(const Grid& grid, const Bounds& bounds) {
  const Mat3d& basis = grid.lattice.basis();
  double points = 1 / std::abs(Determinant(basis));
  for (size_t axis = 0; axis < 3; ++axis) {
    const double extent = std::abs(basis[0][axis]) + std::abs(basis[1][axis]) + std::abs(basis[2][axis]);
    points *= bounds.max[axis] - bounds.min[axis] + extent;
  }
  return points;
}

}  // namespace latvox
