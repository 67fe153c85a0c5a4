#include "core/supercover/supercover.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/supercover/cut_triangle.h"
#include "core/supercover/row_bounds.h"

namespace latvox {
namespace {

using Wide = __int128;
using Vec3l = Vec<int64_t, 3>;

// See the header. A corner may lie a voxel beyond 2^kEdgeBits, which the last bit covers. For a long triangle, the cell
// adds less to a room than the corners do.
static_assert(2 * kZoneBits + 2 * kEdgeBits + 15 <= 127, "rooms must fit __int128");
// The limits of int64: the largest b + D, and the largest D, which the plane needs three times.
constexpr int kNarrowBits = (62 - 17) / 2, kNarrowCornerBits = (62 - 4) / 3;

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

// Returns the scan frames for k = 0 if the cell is a box along the lattice axes, else none.
std::vector<ScanFrame> FramesOfBox(const IntegerCell& cell) {
  const auto is_along_axis = [](const CellZone& zone) {
    return std::abs(zone.e[0]) + std::abs(zone.e[1]) + std::abs(zone.e[2]) == 1;
  };
  if (!std::ranges::all_of(cell.zones(), is_along_axis)) return {};
  std::vector<Frame> frames;
  for (int32_t i : {-1, 0, 1}) {
    for (int32_t j : {-1, 0, 1}) {
      for (int32_t k : {-1, 0, 1}) {
        const Vec3i q{i, j, k};
        if (q != Vec3i{} && FirstNonzeroIsPositive(q)) frames.push_back(*MakeFrame(q));
      }
    }
  }
  return MakeScanFrames(frames);
}

// So many rows of a plane take as long as cutting the triangle to the plane.
constexpr int32_t kFewRows = 32;

}  // namespace

// The sum of a triangle and the cell, relative to the voxel `base`.
template <class Int>
class Supercover::Polytope {
 public:
  Polytope(const Supercover& cover, const Triangle& triangle, const Vec3i& base)
      : cover_(cover),
        cut_(
            {triangle[0] - base * kLatticeUnit, triangle[1] - base * kLatticeUnit, triangle[2] - base * kLatticeUnit}) {
    for (size_t n = 0; n < 3; ++n) {
      for (size_t m = 0; m < 3; ++m) v_[n][m] = triangle[n][m] - base[m] * kLatticeUnit;
    }
    normal_ = Cross(v_[1] - v_[0], v_[2] - v_[0]);
    is_flat_ = (normal_[0] | normal_[1] | normal_[2]) == 0;
    AddPlane();
    AddFacets();
    AddEdges();
  }

  // Calls run for each row of `box`, which is relative, too.
  void ForEachRun(const IndexBox& box, const Vec3i& base, Run run) {
    const Interval all{box.min[2], box.max[2] - 1};
    for (int32_t i = box.min[0]; i < box.max[0]; ++i) {
      const Interval rows = RowsOf(i, {box.min[1], box.max[1] - 1});
      for (int32_t j = rows.first; j <= rows.last;) {
        const int32_t count = std::min(rows.last - j + 1, RowBounds::kRows);
        bounds_.Find(i, j, count, all, rows_);
        for (int32_t n = 0; n < count; ++n, ++j) {
          const Interval k = Decide(i, j, all, {rows_.first[n], rows_.last[n]});
          if (k.first <= k.last) run(base + Vec3i{i, j, k.first}, k.last - k.first + 1);
        }
      }
    }
  }

  // Returns the interval of one row.
  Interval CutRow(int32_t i, int32_t j, Interval k) const {
    for (size_t n = 0; n < size_ && Cut(half_spaces_[n], i, j, k); ++n) continue;
    return k;
  }

 private:
  // Among the rows (i, j), those that cells of the triangle's part between i - half an extent and i + half an extent
  // reach.
  Interval RowsOf(int32_t i, Interval j) const {
    if (j.last - j.first < kFewRows) return j;
    const Vec3i half = cover_.half_extent_lat_ + Vec3i{1, 1, 1};  // because these are rounded down
    const double middle = static_cast<double>(i) * kLatticeUnit;
    const auto [low, high] = cut_.Between(0, middle - half[0], middle + half[0]).Along(1);
    if (low > high) return {0, -1};
    return {std::max(j.first, static_cast<int32_t>(std::ceil((low - half[1]) / kLatticeUnit))),
            std::min(j.last, static_cast<int32_t>(std::floor((high + half[1]) / kLatticeUnit)))};
  }

  // Returns the interval of a row. `k` is what bounds_ has found for it.
  Interval Decide(int32_t i, int32_t j, const Interval& all, Interval k) const {
    if (k.last == RowBounds::kDoubtful) return CutRow(i, j, all);
    for (size_t n = 0; n < steep_count_ && k.first <= k.last; ++n) Cut(half_spaces_[steep_[n]], i, j, k);
    return k;
  }

  Int At(const Vec<Int, 3>& normal, size_t corner) const { return Dot(normal, As<Int>(v_[corner])); }

  void Add(const Vec<Int, 3>& normal, Int room_lat) {
    const auto step = static_cast<double>(normal[2]);
    const double inverse = step == 0 ? 0 : 1 / std::abs(step);
    const HalfSpace<Int> half_space{normal, room_lat >> kSubvoxelBits, inverse};
    if (!bounds_.Add(static_cast<double>(half_space.room), static_cast<double>(normal[0]),
                     static_cast<double>(normal[1]), step, 2 * kMaxExtent)) {
      steep_[steep_count_++] = size_;
    }
    half_spaces_[size_++] = half_space;
  }

  void AddFacets() {
    for (size_t f = 0; f < cover_.facets_.size(); ++f) {
      const Vec<Int, 3> normal = As<Int>(cover_.facets_[f].normal);
      const auto reach = static_cast<Int>(cover_.facets_[f].reach);
      const auto [least, most] = std::minmax({At(normal, 0), At(normal, 1), At(normal, 2)});
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
  bool is_flat_;
  std::array<HalfSpace<Int>, kMaxHalfSpaces> half_spaces_;
  size_t size_ = 0;
  RowBounds bounds_;
  std::array<size_t, kMaxHalfSpaces> steep_;  // half-spaces that bounds_ lacks
  size_t steep_count_ = 0;
  RowBounds::Rows rows_;  // the last ones
};

Supercover::Supercover(const IntegerCell& cell) : cell_(cell), short_(cell) {
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
  scan_frames_ = FramesOfBox(cell_);
  if (scan_frames_.empty()) near_cells_ = NearCells::Of(cell_);
}

Vec3i Supercover::Margin() const { return -Shifted(-half_extent_lat_, kSubvoxelBits); }
Vec3i Supercover::ScanReach() const {
  Vec3i reach = Margin();
  for (size_t m = 0; near_cells_ && m < 3; ++m) reach[m] = std::max(reach[m], near_cells_->steps()[m]);
  return reach;
}
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
  if (corner_bits <= short_.most_bits() && rows.max[1] - rows.min[1] <= kFewRows) {
    const Interval all{rows.min[2], rows.max[2] - 1};
    const auto decide = [&](int32_t i, int32_t j) {
      return Polytope<int64_t>(*this, triangle, base).CutRow(i, j, all);
    };
    if (short_.ForEachRun(triangle, base, rows, run, decide)) return;
  }
  if (corner_bits <= kNarrowCornerBits && cell_.length_bits() + corner_bits <= kNarrowBits) {
    Polytope<int64_t>(*this, triangle, base).ForEachRun(rows, base, run);
  } else {
    Polytope<Wide>(*this, triangle, base).ForEachRun(rows, base, run);
  }
}

}  // namespace latvox
