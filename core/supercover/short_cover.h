// The supercover of short triangles, in doubles that are exact.
#ifndef LATVOX_CORE_SUPERCOVER_SHORT_COVER_H_
#define LATVOX_CORE_SUPERCOVER_SHORT_COVER_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "absl/functional/function_ref.h"
#include "core/brick/brick.h"
#include "core/digitize/crossing.h"
#include "core/lattice/integer_cell.h"
#include "core/supercover/row_bounds.h"

namespace latvox {

// The half-spaces of core/supercover/supercover.h, with their bounds on bits: a triangle is short if none has more
// than 51, and neither has the numerator of the cell's support along the plane's normal. Then doubles hold all of these
// exactly, and four edges, rows or normals take as long as one integer.
class ShortCover {
 public:
  // See Supercover::ForEachRun.
  using Run = absl::FunctionRef<void(const Vec3i& first, int32_t count)>;
  // Returns the interval of the row (i, j), relative to the base.
  using Decide = absl::FunctionRef<Interval(int32_t i, int32_t j)>;

  // For an edge d of a triangle and a zone of the cell.
  struct Rim {
    Mat3d normal{};                            // its rows times d are the normal
    std::array<Vec3d, kMaxZones - 1> along{};  // times d: the reach of another zone along the normal
    size_t zones = 0;                          // in `along`
  };
  struct Facet {
    Vec3d normal;
    double reach;  // of the cell along it, lattice units
  };
  struct Constants {
    std::vector<Rim> rims;
    std::vector<Facet> facets;
    std::vector<std::array<double, 3>>
        directions;  // times a covector: parts of the cell's support, times 2 * determinant
    double twice_determinant;
  };

  explicit ShortCover(const IntegerCell& cell);

  // The number of bits of corners, relative to a voxel, in lattice units.
  int most_bits() const { return most_bits_; }

  // Calls run for each row of `rows`, which is relative to the base, in lexicographic order. They reach no farther than
  // the cells of the triangle's box. Asks `decide` where the
  // doubles of quotients leave a row open. Returns false, without a call, if the triangle has no area, or if it is so
  // steep that doubles are not good enough.
  //   triangle   of most_bits() relative to the base
  bool ForEachRun(const Triangle& triangle, const Vec3i& base, const IndexBox& rows, Run run, Decide decide) const;

 private:
  Constants constants_;
  int most_bits_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_SUPERCOVER_SHORT_COVER_H_
