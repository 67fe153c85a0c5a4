#include "core/supercover/supercover.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/supercover/cut_triangle.h"

namespace latvox {
namespace {

using Wide = __int128;
using Vec3l = Vec<int64_t, 3>;

// See the header. A corner may lie a voxel beyond 2^kEdgeBits, which the last bit covers. For a long triangle, the cell
// adds less to a room than the corners do.
static_assert(2 * kZoneBits + 2 * kEdgeBits + 15 <= 127, "rooms must fit __int128");
// The limits of int64: the largest b + D, and the largest D, which the plane needs three times.
constexpr int kNarrowBits = (62 - 17) / 2, kNarrowCornerBits = (62 - 4) / 3;

// Two for each facet and for the plane, and two for each edge and zone where the triangle has no area.
constexpr size_t kMaxHalfSpaces = kMaxFacets + 2 + 2 * 3 * kMaxZones;

template <class Int>
Int Absolute(Int x) {
  return x < 0 ? -x : x;
}

template <class Int>
Vec<Int, 3> As(const Vec3l& v) {
  return {static_cast<Int>(v[0]), static_cast<Int>(v[1]), static_cast<Int>(v[2])};
}

// normal . c <= room.
template <class Int>
struct HalfSpace {
  Vec<Int, 3> normal;
  Int room;
  double inverse;  // 1 / |normal[2]|, or 0
};

// A row of voxels, k = first .. last.
struct Interval {
  int32_t first, last;
};

// Reduces the interval of the row (i, j) to the points within; false if none is left.
template <class Int>
bool Cut(const HalfSpace<Int>& half_space, int32_t i, int32_t j, Interval& k) {
  const Vec<Int, 3>& normal = half_space.normal;
  const Int room = half_space.room - normal[0] * static_cast<Int>(i) - normal[1] * static_cast<Int>(j);
  const Int step = normal[2];
  if (step == 0) {
    if (room < 0) k.last = k.first - 1;
    return room >= 0;
  }
  // k <= room / step, or -k <= room / -step. A quotient near the row's voxels is wrong by far less than 1.
  const double estimate = static_cast<double>(room) * half_space.inverse;
  const int32_t most = step > 0 ? k.last : -k.first, least = step > 0 ? k.first : -k.last;
  if (estimate >= most + 1) return true;
  int32_t quotient = least - 1;
  if (estimate >= least - 1) {
    const Int size = Absolute(step);
    quotient = static_cast<int32_t>(std::floor(estimate));
    Int rest = room - size * static_cast<Int>(quotient);
    for (; rest < 0; rest += size) --quotient;
    for (; rest >= size; rest -= size) ++quotient;
  }
  if (step > 0) {
    k.last = std::min(k.last, quotient);
  } else {
    k.first = std::max(k.first, -quotient);
  }
  return k.first <= k.last;
}

// Half-spaces on one side of the rows, in doubles: (room - normal . (i, j)) / |normal[2]| for each.
class Slopes {
 public:
  // Terms are below kMaxTerm in size, and the rounding of all of them together is below kDoubt.
  bool Add(double room, double i, double j) {
    if (std::abs(room) + (std::abs(i) + std::abs(j)) * kMaxRow > kMaxTerm) return false;
    room_[size_] = room;
    i_[size_] = i;
    j_[size_] = j;
    ++size_;
    return true;
  }

  double Least(int32_t i, int32_t j) const {
    const double x = i, y = j;
    std::array<double, 4> least;
    least.fill(kMaxTerm * 2);
    size_t n = 0;
    for (; n + 4 <= size_; n += 4) {
      for (size_t m = 0; m < 4; ++m) {
        const double at = room_[n + m] - i_[n + m] * x - j_[n + m] * y;
        least[m] = at < least[m] ? at : least[m];
      }
    }
    for (; n < size_; ++n) least[0] = std::min(least[0], room_[n] - i_[n] * x - j_[n] * y);
    return std::min(std::min(least[0], least[1]), std::min(least[2], least[3]));
  }

 private:
  static constexpr double kMaxRow = 2 * kMaxExtent, kMaxTerm = 1 << 28;

  std::array<double, kMaxHalfSpaces> room_, i_, j_;
  size_t size_ = 0;
};
constexpr double kDoubt = 0x1p-20;

}  // namespace

// The sum of a triangle and the cell, relative to the voxel `base`. A triangle that is small beside a cell meets few
// cells that contain none of its corners. For the others, the cell's own facets decide, and the rest is not needed.
template <class Int>
class Supercover::Polytope {
 public:
  Polytope(const Supercover& cover, const Triangle& triangle, const Vec3i& base, bool is_small)
      : cover_(cover),
        cut_(
            {triangle[0] - base * kLatticeUnit, triangle[1] - base * kLatticeUnit, triangle[2] - base * kLatticeUnit}) {
    for (size_t n = 0; n < 3; ++n) {
      for (size_t m = 0; m < 3; ++m) v_[n][m] = triangle[n][m] - base[m] * kLatticeUnit;
    }
    normal_ = Cross(v_[1] - v_[0], v_[2] - v_[0]);
    is_flat_ = (normal_[0] | normal_[1] | normal_[2]) == 0;
    if (!is_small) AddPlane();
    AddFacets();
    if (!is_small) AddEdges();
    complete_ = !is_small;
  }

  // Calls run for each row of `box`, which is relative, too.
  void ForEachRun(const IndexBox& box, const Vec3i& base, Run run) {
    const Interval all{box.min[2], box.max[2] - 1};
    for (int32_t i = box.min[0]; i < box.max[0]; ++i) {
      const Interval rows = RowsOf(i, {box.min[1], box.max[1] - 1});
      for (int32_t j = rows.first; j <= rows.last; ++j) {
        Interval k = CutRow(i, j, all);
        if (!complete_ && k.first <= k.last && !(HoldsCorner({i, j, k.first}) && HoldsCorner({i, j, k.last}))) {
          AddPlane();
          AddEdges();
          complete_ = true;
          k = CutRow(i, j, all);
        }
        if (k.first <= k.last) run(base + Vec3i{i, j, k.first}, k.last - k.first + 1);
      }
    }
  }

 private:
  // Among the rows (i, j), those that cells of the triangle's part between i - half an extent and i + half an extent
  // reach.
  Interval RowsOf(int32_t i, Interval j) const {
    constexpr int32_t kFewRows = 8;
    if (j.last - j.first < kFewRows) return j;
    const Vec3i half = cover_.half_extent_lat_ + Vec3i{1, 1, 1};  // because these are rounded down
    const double middle = static_cast<double>(i) * kLatticeUnit;
    const auto [low, high] = cut_.Between(0, middle - half[0], middle + half[0]).Along(1);
    if (low > high) return {0, -1};
    return {std::max(j.first, static_cast<int32_t>(std::ceil((low - half[1]) / kLatticeUnit))),
            std::min(j.last, static_cast<int32_t>(std::floor((high + half[1]) / kLatticeUnit)))};
  }

  // Returns the remaining interval of a row. Where doubles cannot decide, integers do.
  Interval CutRow(int32_t i, int32_t j, Interval k) const {
    const double most = upper_.Least(i, j), least = -lower_.Least(i, j);
    const auto is_doubtful = [](double x) { return std::abs(x - std::nearbyint(x)) < kDoubt; };
    if (most < k.first - 1 || least > k.last + 1 || least > most + 1) return {0, -1};
    const bool cuts_last = most<k.last + 1, cuts_first = least> k.first - 1;
    if ((cuts_last && is_doubtful(most)) || (cuts_first && is_doubtful(least))) {
      for (size_t n = 0; n < size_ && Cut(half_spaces_[n], i, j, k); ++n) continue;
      return k;
    }
    if (cuts_last) k.last = std::min(k.last, static_cast<int32_t>(std::floor(most)));
    if (cuts_first) k.first = std::max(k.first, static_cast<int32_t>(std::ceil(least)));
    for (size_t n = 0; n < steep_count_ && k.first <= k.last; ++n) Cut(half_spaces_[steep_[n]], i, j, k);
    return k;
  }

  // Returns whether one of the triangle's corners is in the voxel's cell.
  bool HoldsCorner(const Vec3i& voxel) const {
    std::array<bool, 3> holds{true, true, true};
    for (size_t f = 0; f < cover_.facets_.size(); ++f) {
      const Int at = Dot(As<Int>(cover_.facets_[f].normal), voxel) * kLatticeUnit;
      const auto reach = static_cast<Int>(cover_.facets_[f].reach);
      for (size_t n = 0; n < 3; ++n) holds[n] &= Absolute(facet_at_[f][n] - at) <= reach;
    }
    return holds[0] || holds[1] || holds[2];
  }

  Int At(const Vec<Int, 3>& normal, size_t corner) const { return Dot(normal, As<Int>(v_[corner])); }

  void Add(const Vec<Int, 3>& normal, Int room_lat) {
    const auto step = static_cast<double>(normal[2]);
    const double inverse = step == 0 ? 0 : 1 / std::abs(step);
    const HalfSpace<Int> half_space{normal, room_lat >> kSubvoxelBits, inverse};
    // Half a unit more decides ties, because all other terms are whole.
    const double room = (static_cast<double>(half_space.room) + 0.5) * inverse;
    Slopes& slopes = step > 0 ? upper_ : lower_;
    if (step == 0 ||
        !slopes.Add(room, static_cast<double>(normal[0]) * inverse, static_cast<double>(normal[1]) * inverse)) {
      steep_[steep_count_++] = size_;
    }
    half_spaces_[size_++] = half_space;
  }

  void AddFacets() {
    for (size_t f = 0; f < cover_.facets_.size(); ++f) {
      const Vec<Int, 3> normal = As<Int>(cover_.facets_[f].normal);
      const auto reach = static_cast<Int>(cover_.facets_[f].reach);
      for (size_t n = 0; n < 3; ++n) facet_at_[f][n] = At(normal, n);
      const auto [least, most] = std::minmax({facet_at_[f][0], facet_at_[f][1], facet_at_[f][2]});
      Add(normal, most + reach);
      Add(-normal, reach - least);
    }
  }

  void AddPlane() {
    if (is_flat_) return;
    const auto reach = static_cast<Int>(cover_.cell_.Support(normal_, kLatticeUnit));
    const Vec<Int, 3> up = As<Int>(normal_);
    Add(up, At(up, 0) + reach);
    Add(-up, reach - At(up, 0));
  }

  void AddEdges() {
    for (size_t n = 0; n < 3; ++n) AddEdge(n);
  }

  // The facets along the edge from corner n lie on the side of the edge without the triangle. One that is parallel to
  // the plane is already there.
  void AddEdge(size_t n) {
    const auto& g = cover_.cell_.form();
    const Mat<Int, 3> form{As<Int>(g[0]), As<Int>(g[1]), As<Int>(g[2])};
    const size_t end = (n + 1) % 3, other = (n + 2) % 3;
    const Vec<Int, 3> g_d = Apply(form, As<Int>(v_[end] - v_[n]));
    for (const CellZone& zone : cover_.cell_.zones()) {
      const Vec<Int, 3> a = Cross(g_d, As<Int>({zone.e[0], zone.e[1], zone.e[2]}));
      Vec<Int, 3> normal{};
      Int reach = 0;
      for (const CellZone& u : cover_.cell_.zones()) {
        const Int along = (u.e[0] * a[0] + u.e[1] * a[1] + u.e[2] * a[2]) * static_cast<Int>(u.length);
        for (size_t m = 0; m < 3; ++m) normal[m] += along * u.e[m];
        reach += Absolute(along);
      }
      reach *= kLatticeUnit / 2;
      const Int at = At(normal, n), across = At(normal, other) - at;
      if (across < 0 || (is_flat_ && reach != 0)) Add(normal, at + reach);
      if (across > 0 || (is_flat_ && reach != 0)) Add(-normal, reach - at);
    }
  }

  const Supercover& cover_;
  const CutTriangle cut_;
  std::array<Vec3l, 3> v_;
  Vec3l normal_;
  std::array<std::array<Int, 3>, kMaxFacets / 2> facet_at_;  // of the corners along each facet's normal
  bool is_flat_, complete_;
  std::array<HalfSpace<Int>, kMaxHalfSpaces> half_spaces_;
  size_t size_ = 0;
  Slopes upper_, lower_;                      // bounds of k, and of -k
  std::array<size_t, kMaxHalfSpaces> steep_;  // half-spaces in neither of these
  size_t steep_count_ = 0;
};

Supercover::Supercover(const IntegerCell& cell) : cell_(cell) {
  for (const Vec3i& w : cell_.facets()) {
    Facet facet{Apply(cell_.form(), w), 0};
    for (const CellZone& zone : cell_.zones())
      facet.reach += zone.length * std::abs(Dot(zone.e, w)) * (kLatticeUnit / 2);
    facets_.push_back(facet);
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
  constexpr int32_t kSmall = kLatticeUnit * 2;
  if (corner_bits <= kNarrowCornerBits && cell_.length_bits() + corner_bits <= kNarrowBits) {
    Polytope<int64_t>(*this, triangle, base, longest < kSmall).ForEachRun(rows, base, run);
  } else {
    Polytope<Wide>(*this, triangle, base, longest < kSmall).ForEachRun(rows, base, run);
  }
}

}  // namespace latvox
