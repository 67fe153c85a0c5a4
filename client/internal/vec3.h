// Arithmetic of vectors.
#ifndef LATVOX_CLIENT_INTERNAL_VEC3_H_
#define LATVOX_CLIENT_INTERNAL_VEC3_H_

#include <cmath>

#include "latvox/types.h"

namespace latvox::client {

inline double Dot(const Vec3d& a, const Vec3d& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

inline Vec3d Cross(const Vec3d& a, const Vec3d& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Returns a + t * b.
inline Vec3d Sum(const Vec3d& a, double t, const Vec3d& b) {
  return {a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]};
}

inline double Length(const Vec3d& v) { return std::sqrt(Dot(v, v)); }

inline Vec3d Unit(const Vec3d& v) { return Sum({}, 1 / Length(v), v); }

// Returns i*a + j*b + k*c.
inline Vec3d Combine(const Basis& basis, const Vec3d& ijk) {
  return Sum(Sum(Sum({}, ijk[0], basis.a), ijk[1], basis.b), ijk[2], basis.c);
}

// Returns the dual basis: products of its vectors with a world vector are the lattice coordinates. Precondition: the
// basis is not singular.
inline Basis Dual(const Basis& basis) {
  const Vec3d bc = Cross(basis.b, basis.c), ca = Cross(basis.c, basis.a), ab = Cross(basis.a, basis.b);
  const double inverse = 1 / Dot(basis.a, bc);
  return {Sum({}, inverse, bc), Sum({}, inverse, ca), Sum({}, inverse, ab)};
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_VEC3_H_
