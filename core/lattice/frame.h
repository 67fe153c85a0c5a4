// Frames in which the lattice lines along one direction are a scan-conversion problem.
#ifndef LATVOX_CORE_LATTICE_FRAME_H_
#define LATVOX_CORE_LATTICE_FRAME_H_

#include <optional>
#include <vector>

#include "core/base/vec.h"

namespace latvox {

// Bounds on frames, which the widths in core/digitize rest on.
inline constexpr int kMaxFrameRow = 4;   // sum of absolute entries of a row of R
inline constexpr int kMaxDirection = 8;  // sum of absolute entries of q

// Of pairs +-q of neighbours. Of a lattice's parity classes three have one pair at most, three have two, one has four.
inline constexpr size_t kMaxPairs = 13;

// A unimodular change of lattice coordinates that turns the direction q into the last axis:
//   (a, b, c) = R * ijk     a, b number the lattice lines along q; c counts lattice points on the line
//   ijk = a*u[0] + b*u[1] + c*u[2],   u[2] = q
// (1) R = U^-1, det R = det U = 1   (2) every row of R has absolute sum <= kMaxFrameRow
// The thesis's voxelization matrix M is V*U (section 4.3.1, tables 4.1-4.4).
struct Frame {
  Vec3i q;
  std::array<Vec3i, 3> r;  // rows of R
  std::array<Vec3i, 3> u;  // columns of U
};

// The frame of q with the smallest rows, or nullopt if none is within the bounds. q must be primitive (no common
// factor).
std::optional<Frame> MakeFrame(const Vec3i& q);

// The frame along a plane's principal direction (thesis Definition 2): the first with the largest |normal . q|.
//   normal   covector in lattice coordinates, V^T times the world normal: then normal . q is the world inner product
// Precondition: frames is not empty.
const Frame& PrincipalFrame(const std::vector<Frame>& frames, const Vec<int64_t, 3>& normal);

// Whether the first nonzero entry is positive. It picks one of each pair +-v.
template <class T>
constexpr bool FirstNonzeroIsPositive(const Vec<T, 3>& v) {
  return v[0] != 0 ? v[0] > 0 : v[1] != 0 ? v[1] > 0 : v[2] > 0;
}

}  // namespace latvox

#endif  // LATVOX_CORE_LATTICE_FRAME_H_
