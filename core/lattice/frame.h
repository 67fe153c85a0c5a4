// Frames in which the lattice lines along one direction are a scan-conversion problem, in two and three dimensions.
#ifndef LATVOX_CORE_LATTICE_FRAME_H_
#define LATVOX_CORE_LATTICE_FRAME_H_

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <type_traits>
#include <vector>

#include "core/base/vec.h"

namespace latvox {

// Bounds on frames in space; the bit widths in core/digitize depend on them.
inline constexpr int kMaxFrameRow = 4;   // sum of absolute entries of a row of R
inline constexpr int kMaxDirection = 8;  // sum of absolute entries of q

// The bound on both of them in the plane; the bit widths in core/plane depend on it.
inline constexpr int kPlaneStepBits = 4;
inline constexpr int kMaxPlaneStep = 1 << kPlaneStepBits;

// The most pairs +-q of neighbors in space. Three of a lattice's parity classes hold at most one pair, three hold two,
// and one holds four.
inline constexpr size_t kMaxPairs = 13;

// A unimodular change of lattice coordinates that turns the direction q into the last axis. In space:
//   (a, b, c) = R * ijk     a, b number the lattice lines along q; c counts lattice points on the line
//   ijk = a*u[0] + b*u[1] + c*u[2],   u[2] = q
// In the plane:
//   (a, c) = R * ij,   ij = a*u[0] + c*u[1],   u[1] = q,   r[0] = (q[1], -q[0])
// (1) R = U^-1, det R = det U = 1   (2) every row of R has an absolute sum within the bound above
// The thesis's voxelization matrix M is V*U (section 4.3.1, tables 4.1-4.4).
template <size_t D>
struct BasicFrame {
  Vec<int32_t, D> q;
  std::array<Vec<int32_t, D>, D> r;  // rows of R
  std::array<Vec<int32_t, D>, D> u;  // columns of U
};
using Frame = BasicFrame<3>;
using PlaneFrame = BasicFrame<2>;

// Returns the frame of q with the smallest rows, or nullopt if none is within the bounds. q must be primitive (no
// common factor).
std::optional<Frame> MakeFrame(const Vec3i& q);
std::optional<PlaneFrame> MakeFrame(const Vec2i& q);

// The frame along the principal direction of a plane, or of a line in the plane (thesis Definition 2): the first with
// the largest |normal . q|.
//   normal   covector in lattice coordinates, V^T times the world normal: then normal . q is the world inner product
// Precondition: frames is not empty.
template <size_t D>
const BasicFrame<D>& PrincipalFrame(const std::vector<BasicFrame<D>>& frames,
                                    const std::type_identity_t<Vec<int64_t, D>>& normal) {
  return *std::max_element(frames.begin(), frames.end(), [&](const auto& a, const auto& b) {
    return std::abs(Dot(normal, a.q)) < std::abs(Dot(normal, b.q));
  });
}

// Returns whether the first nonzero entry is positive. It picks one of each pair +-v.
template <class T>
constexpr bool FirstNonzeroIsPositive(const Vec<T, 3>& v) {
  return v[0] != 0 ? v[0] > 0 : v[1] != 0 ? v[1] > 0 : v[2] > 0;
}
template <class T>
constexpr bool FirstNonzeroIsPositive(const Vec<T, 2>& v) {
  return v[0] != 0 ? v[0] > 0 : v[1] > 0;
}

}  // namespace latvox

#endif  // LATVOX_CORE_LATTICE_FRAME_H_
