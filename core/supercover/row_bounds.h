// The voxels of many rows that lie in a convex polytope, in doubles.
#ifndef LATVOX_CORE_SUPERCOVER_ROW_BOUNDS_H_
#define LATVOX_CORE_SUPERCOVER_ROW_BOUNDS_H_

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "core/lattice/integer_cell.h"

namespace latvox {

// Two half-spaces for each facet and for the plane, and two for each edge and zone where the triangle has no area.
inline constexpr size_t kMaxHalfSpaces = kMaxFacets + 2 + 2 * 3 * kMaxZones;

// A row of voxels, k = first .. last.
struct Interval {
  int32_t first, last;
};

// A polytope as half-spaces normal . c <= room, with integers. Half a unit is added to each room. It decides ties,
// because all other terms are whole. Where doubles could be wrong nevertheless, the interval is doubtful.
class RowBounds {
 public:
  // Rows in one call.
  static constexpr int32_t kRows = 64;
  // `last` of doubtful intervals.
  static constexpr int32_t kDoubtful = std::numeric_limits<int32_t>::min();
  // Terms of bounds of k are below kMaxTerm in size, and the rounding of all of them together is below kDoubt.
  static constexpr double kMaxTerm = 1 << 28, kDoubt = 0x1p-20;

  // Bounds room - i * (the row's i) - j * (the row's j).
  struct Side {
    std::array<double, kMaxHalfSpaces> room, i, j;
    size_t size = 0;

    void Add(double room_0, double per_i, double per_j) {
      room[size] = room_0;
      i[size] = per_i;
      j[size++] = per_j;
    }
  };
  struct Sides {
    Side upper, lower;  // bounds of k, and of -k
    Side flat;          // not negative within
  };

  struct Rows {
    alignas(64) std::array<int32_t, kRows> first, last;  // none if first > last
  };

  // Returns false, and adds nothing, if doubles are not good enough for this half-space.
  //   max_row   the largest size of i and j of rows
  bool Add(double room, double i, double j, double k, double max_row) {
    // Flat half-spaces within it are exact, and so are sums of their terms.
    constexpr double kMaxFlatTerm = int64_t{1} << 50;
    room += 0.5;
    if (k == 0) {
      if (std::abs(room) + (std::abs(i) + std::abs(j)) * max_row > kMaxFlatTerm) return false;
      sides_.flat.Add(room, i, j);
      return true;
    }
    const double inverse = 1 / std::abs(k);
    if ((std::abs(room) + (std::abs(i) + std::abs(j)) * max_row) * inverse > kMaxTerm) return false;
    (k > 0 ? sides_.upper : sides_.lower).Add(room * inverse, i * inverse, j * inverse);
    return true;
  }

  // Finds the part of `all` in each of `count` rows (i, j), (i, j + 1), and so on.
  void Find(int32_t i, int32_t j, int32_t count, const Interval& all, Rows& out) const;

 private:
  Sides sides_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_SUPERCOVER_ROW_BOUNDS_H_
