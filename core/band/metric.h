// Exact lengths of lattice vectors.
//
// Frames and units: vectors have integer lattice coordinates in units of 1/kLatticeUnit voxel. The square of a length
// is v^T g v. One voxel size is kLatticeUnit units of length, and its square is `one` * 2^(2 * kSubvoxelBits).
#ifndef LATVOX_CORE_BAND_METRIC_H_
#define LATVOX_CORE_BAND_METRIC_H_

#include <cstdint>

#include "absl/status/statusor.h"
#include "core/base/vec.h"
#include "core/lattice/lattice.h"
#include "core/request/band.h"
#include "core/snap/snap.h"

namespace latvox {

// Bits of a voxel size squared: see Metric.
inline constexpr int kMetricBits = 40;

// Bit widths of absolute values. Entries of g:
inline constexpr int kMetricEntryBits = 60;
// Differences between points of a mesh or its band, per axis:
inline constexpr int kPointBits = kEdgeBits + 1;
static_assert((kMaxBandReach + 2 * kTileSide) * kLatticeUnit < 1 << kEdgeBits);
// Inner products, with nine terms:
inline constexpr int kInnerBits = kMetricEntryBits + 2 * kPointBits + 4;
static_assert(kInnerBits < 127, "inner products must fit a signed integer of 128 bits");

struct Metric {
  // The products of basis vectors; symmetric, positive definite. For the named lattices and for bases of small
  // integers, they are multiples of at least a 1024th of the largest product. Then all entries are integers in the unit
  // of g, and equally long vectors are equally long here. Other products are rounded to multiples of 2^-kMetricBits of
  // a voxel size squared.
  Mat<int64_t, 3> g;
  double one;     // a voxel size squared, in the unit of g: above half of 2^kMetricBits, and at most that
  bool is_exact;  // otherwise, entries of g are wrong by up to a half

  // An upper triangular matrix with root^T root = g / one: a lattice vector v is root * v in some Cartesian
  // coordinates. (root * u) x (root * v) = cofactor * (u x v).
  Mat3d root, cofactor;
  double determinant;  // of root
};

// Errors: INVALID_ARGUMENT if an entry of g needs more bits, or if det g is less than 2^-10 of the product of its
// diagonal. Such a basis is too skewed for distances; a reduced basis is not.
//
// With that, root and cofactor have relative errors below 2^-36. So do squares of lengths that doubles compute by them
// from exact integers. The bound is 2^-53, times some 2^4 operations, times the condition of g with a diagonal scaled
// to 1. That condition is at most 3 / (2^-10 * 4 / 9) < 2^13.
absl::StatusOr<Metric> MakeMetric(const Lattice& lattice);

// Returns u^T g v, exactly. Precondition: coordinates within kPointBits.
constexpr __int128 Inner(const Metric& metric, const Vec3i& u, const Vec3i& v) {
  __int128 sum = 0;
  for (size_t c = 0; c < 3; ++c) {
    for (size_t r = 0; r < 3; ++r) sum += static_cast<__int128>(metric.g[c][r]) * u[r] * v[c];
  }
  return sum;
}

}  // namespace latvox

#endif  // LATVOX_CORE_BAND_METRIC_H_
