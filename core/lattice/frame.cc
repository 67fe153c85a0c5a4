#include "core/lattice/frame.h"

#include "core/lattice/small_vectors.h"

namespace latvox {
namespace {

// All integer vectors that may be a row, smallest first.
template <size_t D>
const std::vector<Vec<int32_t, D>>& Rows() {
  static const auto* rows = [] {
    constexpr int32_t kMost = D == 3 ? kMaxFrameRow : kMaxPlaneStep;
    auto* all = new std::vector<Vec<int32_t, D>>;
    ForEachInCube<D>(kMost, [&](const Vec<int32_t, D>& v) {
      if (AbsoluteSum(v) != 0 && AbsoluteSum(v) <= kMost) all->push_back(v);
    });
    std::stable_sort(all->begin(), all->end(),
                     [](const auto& a, const auto& b) { return AbsoluteSum(a) < AbsoluteSum(b); });
    return all;
  }();
  return *rows;
}

// The smallest row whose product with q is 1: the last row of the frame.
template <size_t D>
std::optional<Vec<int32_t, D>> LastRow(const Vec<int32_t, D>& q) {
  for (const auto& row : Rows<D>()) {
    if (Dot(row, q) == 1) return row;
  }
  return std::nullopt;
}

}  // namespace

// Rows 0 and 1 must span the integer vectors orthogonal to q: they do iff their cross product is q itself, since q is
// primitive.
std::optional<Frame> MakeFrame(const Vec3i& q) {
  if (AbsoluteSum(q) > kMaxDirection) return std::nullopt;
  const std::optional<Vec3i> last = LastRow(q);
  if (!last) return std::nullopt;
  std::vector<Vec3i> flat;
  for (const Vec3i& row : Rows<3>()) {
    if (Dot(row, q) == 0) flat.push_back(row);
  }
  for (size_t n = 1; n < flat.size(); ++n) {
    for (size_t m = 0; m < n; ++m) {
      if (Cross(flat[m], flat[n]) != q) continue;
      const Vec3i &r0 = flat[m], &r1 = flat[n], &r2 = *last;
      return Frame{q, {r0, r1, r2}, {Cross(r1, r2), Cross(r2, r0), q}};
    }
  }
  return std::nullopt;
}

// Row 0 is the only one, up to its sign, that spans the integer vectors orthogonal to q. The extended Euclidean
// algorithm finds a row 1 no longer than q, so the search does.
std::optional<PlaneFrame> MakeFrame(const Vec2i& q) {
  if (AbsoluteSum(q) > kMaxPlaneStep) return std::nullopt;
  const std::optional<Vec2i> last = LastRow(q);
  if (!last) return std::nullopt;
  return PlaneFrame{q, {{{q[1], -q[0]}, *last}}, {{{(*last)[1], -(*last)[0]}, q}}};
}

}  // namespace latvox
