// Where a crossed link meets a triangle: the share of its length, exactly.
//
// Let n be the triangle's normal, A a corner, and q the step from z along the link. The triangle's plane is at the
// share s = n . (A - z) / n . q. The crossing rule (core/digitize/star.h) says that the link is crossed only if the
// plane, after the infinitesimal shift, lies strictly between its ends. So s is in [0, 1], and the share from the other
// end is 1 - s.
//
// Where z lies on the mesh, s is 0, but the shift has moved the mesh away from z along q. No share is 0: the smallest
// positive normal float stands for it. It differs from all other shares, which are above 2^-62. Programs that flush
// denormals keep it. Its sum with the share 1 from the other end rounds to 1.
#ifndef LATVOX_CORE_FIELDS_LINK_SHARE_H_
#define LATVOX_CORE_FIELDS_LINK_SHARE_H_

#include <bit>
#include <cmath>
#include <compare>
#include <cstdint>
#include <limits>

#include "core/base/vec.h"
#include "core/digitize/star.h"
#include "core/snap/snap.h"

namespace latvox {

// The share of a link whose end lies on the mesh.
inline constexpr float kShareOnPoint = std::numeric_limits<float>::min();

// numerator / denominator, 0 <= numerator <= denominator, 0 < denominator < 2^kDepthDenominatorBits.
struct LinkShare {
  uint64_t numerator, denominator;

  // From the other end of the link.
  LinkShare FromOtherEnd() const { return {denominator - numerator, denominator}; }

  // The nearest float, ties to even; kShareOnPoint for 0.
  float ToFloat() const;
};

// Compares the numbers.
inline std::weak_ordering operator<=>(const LinkShare& a, const LinkShare& b) {
  using Wide = unsigned __int128;
  return Wide{a.numerator} * b.denominator <=> Wide{b.numerator} * a.denominator;
}

// The plane of a triangle, seen from one lattice point z.
class SharesAt {
 public:
  // The products may take more than 64 bits. Their sum does not for an end of a crossed link, so it is right modulo
  // 2^64.
  SharesAt(const OrientedTriangle& triangle, const Vec3i& z) : normal_(triangle.normal) {
    for (size_t m = 0; m < 3; ++m) {
      const int64_t offset = int64_t{z[m]} * kLatticeUnit - triangle.v[0][m];
      distance_ += static_cast<uint64_t>(normal_[m]) * static_cast<uint64_t>(offset);
    }
    if (static_cast<int64_t>(distance_) < 0) distance_ = -distance_;
  }

  // Precondition: the triangle crosses the link z -> z + q.
  LinkShare Along(const Vec3i& q) const {
    const int64_t along = Dot(normal_, q);
    return {distance_, static_cast<uint64_t>(along < 0 ? -along : along) * kLatticeUnit};
  }

 private:
  const Vec<int64_t, 3>& normal_;
  uint64_t distance_ = 0;  // |n . (z - A)|
};

inline float LinkShare::ToFloat() const {
  if (numerator == 0) return kShareOnPoint;
  // Three roundings: at most three units wrong in the last place. Only near the middle between two floats does that
  // matter.
  const auto signed_double = [](uint64_t x) { return static_cast<double>(static_cast<int64_t>(x)); };  // is faster
  const double quotient = signed_double(numerator) / signed_double(denominator);
  constexpr int kDropped = std::numeric_limits<double>::digits - std::numeric_limits<float>::digits;
  constexpr uint64_t kMiddle = uint64_t{1} << (kDropped - 1), kDoubt = 4;
  const uint64_t dropped = std::bit_cast<uint64_t>(quotient) & (2 * kMiddle - 1);
  if (dropped - (kMiddle - kDoubt) > 2 * kDoubt) return static_cast<float>(quotient);
  // Two bits more than a float has, and a last bit for the rest.
  const int shift = 26 + std::countl_zero(numerator) - std::countl_zero(denominator);
  const unsigned __int128 scaled = static_cast<unsigned __int128>(numerator) << shift;
  const auto whole = static_cast<uint64_t>(scaled / denominator);
  const uint64_t rest = scaled % denominator != 0 ? 1 : 0;
  return std::ldexp(static_cast<float>(2 * whole + rest), -shift - 1);
}

}  // namespace latvox

#endif  // LATVOX_CORE_FIELDS_LINK_SHARE_H_
