#include "core/digitize/supercover.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace latvox {
namespace {

using Wide = __int128;
using Vec3l = Vec<int64_t, 3>;

// See the header. A corner may lie a voxel beyond 2^kEdgeBits, which the last bit covers; of a long triangle, what the
// cell adds to a room is less than what the corners do.
static_assert(2 * kZoneBits + 2 * kEdgeBits + 15 <= 127, "rooms must fit __int128");
// What fits int64: the largest b + D, and the largest D, of which the plane takes thrice.
constexpr int kNarrowBits = (62 - 17) / 2, kNarrowCornerBits = (62 - 4) / 3;

// Two of each facet and of the plane, and two of each edge and zone where the triangle has no area.
constexpr size_t kMaxHalfSpaces = kMaxFacets + 2 + 2 * 3 * kMaxZones;

template <class Int>
Int Absolute(Int x) {
  return x < 0 ? -x : x;
}

template <class Int>
Vec<Int, 3> As(const Vec3l& v) {
  return {static_cast<Int>(v[0]), static_cast<Int>(v[1]), static_cast<Int>(v[2])};
}

// normal . c <= room. Where k counts, it is the floor of a quotient that a double tells nearly always.
template <class Int>
struct HalfSpace {
  Vec<Int, 3> normal;
  Int room;
  double inverse;  // 1 / |normal[2]|, or 0
};

// Keeps of the row's k in first .. last those within; false if none is left.
template <class Int>
bool Cut(const HalfSpace<Int>& half_space, Int room, int32_t& first, int32_t& last) {
  const Int step = half_space.normal[2];
  if (step == 0) return room >= 0;
  // k <= room / step, or -k <= room / -step. A quotient near the row's voxels is off by far less than 1.
  const double estimate = static_cast<double>(room) * half_space.inverse;
  const int32_t most = step > 0 ? last : -first, least = step > 0 ? first : -last;
  if (estimate >= most + 1) return true;
  if (estimate < least - 1) return false;
  const Int size = Absolute(step);
  auto quotient = static_cast<int32_t>(std::floor(estimate));
  Int rest = room - size * static_cast<Int>(quotient);
  while (rest < 0) {
    rest += size;
    --quotient;
  }
  while (rest >= size) {
    rest -= size;
    ++quotient;
  }
  if (step > 0) {
    last = std::min(last, quotient);
  } else {
    first = std::max(first, -quotient);
  }
  return first <= last;
}

}  // namespace

// The sum of a triangle and the cell, relative to the voxel `base`.
template <class Int>
class Supercover::Polytope {
 public:
  Polytope(const Supercover& cover, const Triangle& triangle, const Vec3i& base) : cell_(cover.cell_) {
    for (size_t n = 0; n < 3; ++n) {
      for (size_t m = 0; m < 3; ++m) v_[n][m] = triangle[n][m] - base[m] * kLatticeUnit;
    }
    const Vec3l normal = Cross(v_[1] - v_[0], v_[2] - v_[0]);
    flat_ = normal == Vec3l{};
    if (!flat_) AddPlane(normal);
    for (const Facet& facet : cover.facets_) {
      Int most = At(As<Int>(facet.normal), 0);
      for (size_t n = 1; n < 3; ++n) most = std::max(most, At(As<Int>(facet.normal), n));
      Add(As<Int>(facet.normal), most + static_cast<Int>(facet.reach));
    }
    for (size_t n = 0; n < 3; ++n) AddEdge(n);
  }

  // Calls run for each row of `box`, which is relative, too.
  void ForEachRun(const IndexBox& box, const Vec3i& base, Run run) const {
    std::array<Int, kMaxHalfSpaces> rooms;
    for (int32_t i = box.min[0]; i < box.max[0]; ++i) {
      for (size_t n = 0; n < size_; ++n)
        rooms[n] = half_spaces_[n].room - half_spaces_[n].normal[0] * static_cast<Int>(i);
      for (int32_t j = box.min[1]; j < box.max[1]; ++j) {
        int32_t first = box.min[2], last = box.max[2] - 1;
        bool any = true;
        for (size_t n = 0; n < size_ && any; ++n) {
          const HalfSpace<Int>& half_space = half_spaces_[n];
          any = Cut(half_space, static_cast<Int>(rooms[n] - half_space.normal[1] * static_cast<Int>(j)), first, last);
        }
        if (any) run(base + Vec3i{i, j, first}, last - first + 1);
      }
    }
  }

 private:
  Int At(const Vec<Int, 3>& normal, size_t corner) const { return Dot(normal, As<Int>(v_[corner])); }

  void Add(const Vec<Int, 3>& normal, Int room_lat) {
    const double step = std::abs(static_cast<double>(normal[2]));
    half_spaces_[size_++] = {normal, room_lat >> kSubvoxelBits, step == 0 ? 0 : 1 / step};
  }

  void AddPlane(const Vec3l& normal) {
    const auto reach = static_cast<Int>(cell_.Support(normal, kLatticeUnit));
    const Vec<Int, 3> up = As<Int>(normal);
    Add(up, At(up, 0) + reach);
    Add(-up, reach - At(up, 0));
  }

  // The facets along the edge from corner n on lie on the side of the edge where the triangle does not; one that is
  // parallel to the plane is there already.
  void AddEdge(size_t n) {
    const size_t end = (n + 1) % 3, other = (n + 2) % 3;
    const Vec<Int, 3> g_d = Apply(Form(), As<Int>(v_[end] - v_[n]));
    for (const CellZone& zone : cell_.zones()) {
      const Vec<Int, 3> a = Cross(g_d, As<Int>({zone.e[0], zone.e[1], zone.e[2]}));
      Vec<Int, 3> normal{};
      Int reach = 0;
      for (const CellZone& u : cell_.zones()) {
        const Int along = (u.e[0] * a[0] + u.e[1] * a[1] + u.e[2] * a[2]) * static_cast<Int>(u.length);
        for (size_t m = 0; m < 3; ++m) normal[m] += along * u.e[m];
        reach += Absolute(along);
      }
      reach *= kLatticeUnit / 2;
      const Int at = At(normal, n), across = At(normal, other) - at;
      if (across < 0 || (flat_ && normal != Vec<Int, 3>{})) Add(normal, at + reach);
      if (across > 0 || (flat_ && normal != Vec<Int, 3>{})) Add(-normal, reach - at);
    }
  }

  Mat<Int, 3> Form() const {
    const auto& g = cell_.form();
    return {As<Int>(g[0]), As<Int>(g[1]), As<Int>(g[2])};
  }

  const IntegerCell& cell_;
  std::array<Vec3l, 3> v_;
  bool flat_;
  std::array<HalfSpace<Int>, kMaxHalfSpaces> half_spaces_;
  size_t size_ = 0;
};

Supercover::Supercover(const IntegerCell& cell) : cell_(cell) {
  for (const Vec3i& w : cell_.facets()) {
    Facet facet{Apply(cell_.form(), w), 0};
    for (const CellZone& zone : cell_.zones())
      facet.reach += zone.length * std::abs(Dot(zone.e, w)) * (kLatticeUnit / 2);
    facets_.push_back(facet);
    facets_.push_back({-facet.normal, facet.reach});
  }
  for (size_t m = 0; m < 3; ++m) {
    Vec3l axis{};
    axis[m] = 1;
    half_extent_lat_[m] = static_cast<int32_t>(cell_.Support(axis, kLatticeUnit));
  }
}

Vec3i Supercover::Margin() const { return -Shifted(-half_extent_lat_, kSubvoxelBits); }
Vec3i Supercover::Reach() const { return -Shifted(-(half_extent_lat_ * 2), kSubvoxelBits); }

void Supercover::ForEachRun(const Triangle& triangle, const IndexBox& box, Run run) const {
  Vec3i base;
  IndexBox rows;
  int32_t longest = 0;
  for (size_t m = 0; m < 3; ++m) {
    const auto [low, high] = std::minmax({triangle[0][m], triangle[1][m], triangle[2][m]});
    base[m] = low >> kSubvoxelBits;
    longest = std::max(longest, high - base[m] * kLatticeUnit);
    rows.min[m] = std::max((low - half_extent_lat_[m] + kLatticeUnit - 1) >> kSubvoxelBits, box.min[m]) - base[m];
    rows.max[m] = std::min((high + half_extent_lat_[m]) >> kSubvoxelBits, box.max[m] - 1) + 1 - base[m];
    if (rows.min[m] >= rows.max[m]) return;
  }
  int corner_bits = 0;
  while (longest >> corner_bits != 0) ++corner_bits;
  if (corner_bits <= kNarrowCornerBits && cell_.length_bits() + corner_bits <= kNarrowBits) {
    Polytope<int64_t>(*this, triangle, base).ForEachRun(rows, base, run);
  } else {
    Polytope<Wide>(*this, triangle, base).ForEachRun(rows, base, run);
  }
}

}  // namespace latvox
