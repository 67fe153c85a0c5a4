// Small fixed-size vectors and matrices.
#ifndef LATVOX_CORE_BASE_VEC_H_
#define LATVOX_CORE_BASE_VEC_H_

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace latvox {

template <class T, size_t D>
using Vec = std::array<T, D>;
using Vec3d = Vec<double, 3>;
using Vec3f = Vec<float, 3>;
using Vec3i = Vec<int32_t, 3>;
using Vec2d = Vec<double, 2>;
using Vec2i = Vec<int32_t, 2>;
using Vec2l = Vec<int64_t, 2>;

// A matrix as its columns: m[c][r].
template <class T, size_t D>
using Mat = std::array<Vec<T, D>, D>;
using Mat3d = Mat<double, 3>;
using Mat2d = Mat<double, 2>;

template <class T, size_t D>
constexpr Vec<T, D> operator+(Vec<T, D> a, const Vec<T, D>& b) {
  for (size_t m = 0; m < D; ++m) a[m] += b[m];
  return a;
}

template <class T, size_t D>
constexpr Vec<T, D> operator-(Vec<T, D> a, const Vec<T, D>& b) {
  for (size_t m = 0; m < D; ++m) a[m] -= b[m];
  return a;
}

template <class T, size_t D>
constexpr Vec<T, D> operator-(Vec<T, D> a) {
  for (T& x : a) x = -x;
  return a;
}

template <class T, size_t D>
constexpr Vec<T, D> operator*(Vec<T, D> a, T s) {
  for (T& x : a) x *= s;
  return a;
}

// Each coordinate divided by 2^bits, rounded down.
template <size_t D>
constexpr Vec<int32_t, D> Shifted(Vec<int32_t, D> v, int bits) {
  for (int32_t& x : v) x >>= bits;
  return v;
}

// Inner product, in the wider of the two types.
template <class A, class B, size_t D>
constexpr auto Dot(const Vec<A, D>& a, const Vec<B, D>& b) {
  decltype(A{} * B{}) sum{};
  for (size_t m = 0; m < D; ++m) sum += a[m] * b[m];
  return sum;
}

inline double LengthOf(const Vec3d& v) { return std::sqrt(Dot(v, v)); }

template <class T>
constexpr Vec<T, 3> Cross(const Vec<T, 3>& a, const Vec<T, 3>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <class T>
constexpr Vec3d ToDouble(const Vec<T, 3>& v) {
  return {static_cast<double>(v[0]), static_cast<double>(v[1]), static_cast<double>(v[2])};
}

template <class T>
constexpr T Determinant(const Mat<T, 3>& m) {
  return Dot(m[0], Cross(m[1], m[2]));
}

template <class T>
constexpr T Determinant(const Mat<T, 2>& m) {
  return m[0][0] * m[1][1] - m[0][1] * m[1][0];
}

// m^-1, which has infinite or NaN entries if m is singular.
constexpr Mat3d Inverse(const Mat3d& m) {
  const double det = Determinant(m);
  const std::array<Vec3d, 3> rows{Cross(m[1], m[2]), Cross(m[2], m[0]), Cross(m[0], m[1])};
  Mat3d inverse{};
  for (size_t c = 0; c < 3; ++c) {
    for (size_t r = 0; r < 3; ++r) inverse[c][r] = rows[r][c] / det;
  }
  return inverse;
}

constexpr Mat2d Inverse(const Mat2d& m) {
  const double det = Determinant(m);
  return {{{m[1][1] / det, -m[0][1] / det}, {-m[1][0] / det, m[0][0] / det}}};
}

// m * v.
template <class T, class S, size_t D>
constexpr auto Apply(const Mat<T, D>& m, const Vec<S, D>& v) {
  Vec<decltype(T{} * S{}), D> out{};
  for (size_t c = 0; c < D; ++c) {
    for (size_t r = 0; r < D; ++r) out[r] += m[c][r] * v[c];
  }
  return out;
}

}  // namespace latvox

#endif  // LATVOX_CORE_BASE_VEC_H_
