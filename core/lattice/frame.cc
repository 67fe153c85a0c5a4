#include "core/lattice/frame.h"

#include <algorithm>
#include <cstdlib>

namespace latvox {
namespace {

int AbsoluteSum(const Vec3i& v) { return std::abs(v[0]) + std::abs(v[1]) + std::abs(v[2]); }

// All integer vectors that may be a row, smallest first.
const std::vector<Vec3i>& Rows() {
  static const auto* rows = [] {
    auto* all = new std::vector<Vec3i>;
    for (int i = -kMaxFrameRow; i <= kMaxFrameRow; ++i) {
      for (int j = -kMaxFrameRow; j <= kMaxFrameRow; ++j) {
        for (int k = -kMaxFrameRow; k <= kMaxFrameRow; ++k) {
          const Vec3i v{i, j, k};
          if (AbsoluteSum(v) != 0 && AbsoluteSum(v) <= kMaxFrameRow) all->push_back(v);
        }
      }
    }
    std::stable_sort(all->begin(), all->end(),
                     [](const Vec3i& a, const Vec3i& b) { return AbsoluteSum(a) < AbsoluteSum(b); });
    return all;
  }();
  return *rows;
}

}  // namespace

// Rows 0 and 1 must span the integer vectors orthogonal to q: they do iff their cross product is q itself, since q is
// primitive. Row 2 is any vector whose product with q is 1.
std::optional<Frame> MakeFrame(const Vec3i& q) {
  if (AbsoluteSum(q) > kMaxDirection) return std::nullopt;
  std::vector<Vec3i> flat;
  std::optional<Vec3i> up;
  for (const Vec3i& row : Rows()) {
    const int dot = Dot(row, q);
    if (dot == 0) flat.push_back(row);
    if (dot == 1 && !up) up = row;
  }
  if (!up) return std::nullopt;
  for (size_t n = 1; n < flat.size(); ++n) {
    for (size_t m = 0; m < n; ++m) {
      if (Cross(flat[m], flat[n]) != q) continue;
      const Vec3i &r0 = flat[m], &r1 = flat[n], &r2 = *up;
      return Frame{q, {r0, r1, r2}, {Cross(r1, r2), Cross(r2, r0), q}};
    }
  }
  return std::nullopt;
}

const Frame& PrincipalFrame(const std::vector<Frame>& frames, const Vec<int64_t, 3>& normal) {
  return *std::max_element(frames.begin(), frames.end(), [&](const Frame& a, const Frame& b) {
    return std::abs(Dot(normal, a.q)) < std::abs(Dot(normal, b.q));
  });
}

}  // namespace latvox
