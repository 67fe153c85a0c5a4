#include "core/thesis/seams.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace latvox {
namespace {

using Vec3l = Vec<int64_t, 3>;

// { z : -t < n.z <= t } for a plane through 0, everything times 2|n|.
struct Slab {
  Vec3l normal;
  int64_t two_t;

  Slab(const Vec3l& n, const std::vector<Frame>& frames) : normal(n), two_t(0) {
    for (const Frame& frame : frames) two_t = std::max(two_t, std::abs(Dot(normal, frame.q)));
  }
};

bool InSeam(const std::vector<Slab>& slabs, const Vec3l& from_a) {
  bool in_one = false;
  for (const Slab& slab : slabs) {
    const int64_t twice = 2 * Dot(slab.normal, from_a);
    if (std::abs(twice) > slab.two_t) return false;
    in_one |= twice != -slab.two_t;
  }
  return in_one;
}

size_t LongestAxis(const Vec3i& v) {
  size_t longest = 0;
  for (size_t m = 1; m < 3; ++m) {
    if (std::abs(v[m]) > std::abs(v[longest])) longest = m;
  }
  return longest;
}

}  // namespace

// Slices across the edge's longest axis, each with the box around the piece of the edge that its voxels may be near.
void Seam(const Vec3i& a, const Vec3i& b, const std::vector<Vec3l>& normals, const Neighborhood& neighborhood,
          StopSignal stop, EmitVoxel emit) {
  std::vector<Slab> slabs;
  slabs.reserve(normals.size());
  for (const Vec3l& normal : normals) {
    if (stop.Stopped()) return;
    slabs.emplace_back(normal, neighborhood.frames);
  }
  const Tube tube(neighborhood, ToDouble(a), ToDouble(b));
  const Vec3d& ball = neighborhood.ball;
  const Vec3i edge = b - a;
  const size_t m = LongestAxis(edge), m1 = (m + 1) % 3, m2 = (m + 2) % 3;

  const auto [low_end, high_end] = std::minmax(a[m], b[m]);
  const auto reach = static_cast<int32_t>(std::floor(ball[m]));
  for (int32_t slice = low_end - reach; slice <= high_end + reach; ++slice) {
    const auto parameter = [&](double x) { return std::clamp((x - a[m]) / edge[m], 0.0, 1.0); };
    const double s0 = parameter(slice - ball[m]), s1 = parameter(slice + ball[m]);
    Vec3i low, high;
    for (const size_t axis : {m1, m2}) {
      const auto [from, to] = std::minmax({a[axis] + s0 * edge[axis], a[axis] + s1 * edge[axis]});
      low[axis] = static_cast<int32_t>(std::ceil(from - ball[axis]));
      high[axis] = static_cast<int32_t>(std::floor(to + ball[axis]));
    }
    Vec3i z;
    z[m] = slice;
    for (z[m1] = low[m1]; z[m1] <= high[m1]; ++z[m1]) {
      for (z[m2] = low[m2]; z[m2] <= high[m2]; ++z[m2]) {
        if (stop.Stopped()) return;  // an edge of millions of triangles takes milliseconds for each voxel
        const Vec3i from_a = z - a;
        if (InSeam(slabs, {from_a[0], from_a[1], from_a[2]}) && tube.Contains(ToDouble(z))) emit(z);
      }
    }
  }
}

}  // namespace latvox
