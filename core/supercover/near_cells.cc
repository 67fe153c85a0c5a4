// Pairs of voxel and triangle in lanes of integers.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/supercover/near_cells.cc"
#include "core/supercover/near_cells.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "core/lattice/small_vectors.h"
#include "core/triangles/padded_vertices.h"
#include "core/triangles/positions-inl.h"
#include "core/triangles/triangle_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR
// FindCoverCandidates has left all triangles, so there are no pairs.
void KeepInLanes(const NearCells::Constants&, const SnappedMesh&, const BitsLayout&, std::vector<VoxelTriangle>&) {}
#else

namespace hn = hwy::HWY_NAMESPACE;

HWY_INLINE Ints Times(const Ints3& v, const Vec3i& by) { return DotOf(v, Fill3(by)); }

// Triangles as seen from voxels, in lanes.
struct SeenTriangles {
  std::array<Ints3, 3> v, moment;  // corners, and the products of each one and the next
  Ints3 normal;

  //   pairs   kTriangleLanes of them
  HWY_INLINE SeenTriangles(const SnappedMesh& mesh, const BitsLayout& layout, const VoxelTriangle* pairs) {
    uint32_t voxels[kTriangleLanes], triangles[kTriangleLanes];
    for (size_t n = 0; n < kTriangleLanes; ++n) {
      voxels[n] = pairs[n].voxel;
      triangles[n] = pairs[n].triangle;
    }
    const hn::RebindToUnsigned<Lanes> du;
    const Ints3 at = PositionsOf(layout, hn::BitCast(Lanes(), hn::LoadU(du, voxels)));
    v = LoadCorners(mesh, PaddedVertices(mesh), LaneNumbers(triangles), Vec3i{});
    for (Ints3& corner : v) corner = Minus(corner, at);
    for (size_t n = 0; n < 3; ++n) moment[n] = CrossOf(v[n], v[(n + 1) % 3]);
    for (size_t m = 0; m < 3; ++m) normal[m] = hn::Add(hn::Add(moment[0][m], moment[1][m]), moment[2][m]);
  }
};

// 2 * parts * w / U: the sum of the steps, each in the direction in which it climbs along the normal.
HWY_INLINE Ints3 CornerAlong(const NearCells::Constants& cell, const Ints3& normal) {
  Ints3 corner = Fill3({});
  for (const Vec3i& step : cell.steps) {
    const Ints down = hn::BroadcastSignBit(Times(normal, step));  // -1 or 0
    for (size_t m = 0; m < 3; ++m) corner[m] = hn::Add(corner[m], hn::Sub(hn::Xor(Fill(step[m]), down), down));
  }
  return corner;
}

// Bit n: the plane of lane n has a point of the voxel's cell. All numbers are whole and below 2^53.
template <class D, class Part>
HWY_INLINE uint64_t ReachesPlane(D d, const NearCells::Constants& cell, const SeenTriangles& seen, const Ints3& corner,
                                 const Part& part) {
  auto at = hn::Zero(d), reach = at;
  for (size_t m = 0; m < 3; ++m) {
    const auto normal = hn::PromoteTo(d, part(seen.normal[m]));
    at = hn::MulAdd(normal, hn::PromoteTo(d, part(seen.v[0][m])), at);
    reach = hn::MulAdd(normal, hn::PromoteTo(d, part(corner[m])), reach);
  }
  const auto within =
      hn::Le(hn::Mul(hn::Abs(at), hn::Set(d, cell.denominator)), hn::Mul(reach, hn::Set(d, cell.numerator)));
  uint64_t bits = 0;
  hn::StoreMaskBits(d, within, reinterpret_cast<uint8_t*>(&bits));
  return bits;
}

HWY_INLINE uint64_t ReachesPlane(const NearCells::Constants& cell, const SeenTriangles& seen, const Ints3& corner) {
  const hn::Half<Lanes> half;
  const hn::Rebind<double, decltype(half)> d;
  const uint64_t low = ReachesPlane(d, cell, seen, corner, [&](Ints x) HWY_ATTR { return hn::LowerHalf(half, x); });
  const uint64_t high = ReachesPlane(d, cell, seen, corner, [&](Ints x) HWY_ATTR { return hn::UpperHalf(half, x); });
  return low | high << kTriangleLanes / 2;
}

// The facets along each zone, with their weights.
struct FacetsOfZones {
  struct Entry {
    size_t facet;
    int32_t weight;
  };
  std::array<std::array<Entry, NearCells::kFacets>, kMaxZones> entries;
  std::array<size_t, kMaxZones> counts{};

  explicit FacetsOfZones(const NearCells::Constants& cell) {
    for (size_t r = 0; r < cell.steps.size(); ++r) {
      for (size_t f = 0; f < cell.facets.size(); ++f) {
        if (cell.weights[r][f] != 0) entries[r][counts[r]++] = {f, cell.weights[r][f]};
      }
    }
  }
};

// Bit n: a facet's normal, or an edge and a zone, separate voxel n's cell from the triangle. For the edge d from corner
// A to B and the zone g, the axis is d x g. There, A and B are at (A x B) . g, and the other corner is at
// (A x B - n) . g, because the normal n is the sum of the three products.
HWY_INLINE uint64_t Separated(const NearCells::Constants& cell, const FacetsOfZones& along, const SeenTriangles& seen) {
  auto separated = hn::FirstN(Lanes(), 0);
  const auto check = [&](Ints low, Ints high, Ints reach)
                         HWY_ATTR { separated = hn::Or(separated, hn::Gt(hn::Max(low, hn::Neg(high)), reach)); };
  Ints over[3][NearCells::kFacets];  // |edge . f|
  for (size_t f = 0; f < cell.facets.size(); ++f) {
    const auto& [normal, reach] = cell.facets[f];
    const Ints a = Times(seen.v[0], normal), b = Times(seen.v[1], normal), c = Times(seen.v[2], normal);
    check(Least(a, b, c), Most(a, b, c), Fill(reach));
    over[0][f] = hn::Abs(hn::Sub(b, a));
    over[1][f] = hn::Abs(hn::Sub(c, b));
    over[2][f] = hn::Abs(hn::Sub(a, c));
  }
  for (size_t r = 0; r < cell.steps.size(); ++r) {
    const Ints3 step = Fill3(cell.steps[r] * cell.denominator);
    const Ints at[3] = {DotOf(seen.moment[0], step), DotOf(seen.moment[1], step), DotOf(seen.moment[2], step)};
    const Ints of_normal = hn::Add(hn::Add(at[0], at[1]), at[2]);
    for (size_t n = 0; n < 3; ++n) {
      Ints reach = hn::Zero(Lanes());
      for (size_t m = 0; m < along.counts[r]; ++m) {
        const auto& [facet, weight] = along.entries[r][m];
        reach = hn::Add(reach, hn::Mul(over[n][facet], Fill(weight)));
      }
      const Ints other = hn::Sub(at[n], of_normal);
      check(hn::Min(at[n], other), hn::Max(at[n], other), reach);
    }
  }
  return BitsOf(separated);
}

void KeepInLanes(const NearCells::Constants& cell, const SnappedMesh& mesh, const BitsLayout& layout,
                 std::vector<VoxelTriangle>& pairs) {
  const size_t size = pairs.size();
  if (size == 0) return;
  pairs.resize(size + kTriangleLanes, pairs.back());
  const FacetsOfZones along(cell);
  size_t kept = 0;
  for (size_t first = 0; first < size; first += kTriangleLanes) {
    const SeenTriangles seen(mesh, layout, pairs.data() + first);
    uint64_t meets = ReachesPlane(cell, seen, CornerAlong(cell, seen.normal)) & ~Separated(cell, along, seen);
    for (size_t n = first; n < std::min(size, first + kTriangleLanes); ++n, meets >>= 1) {
      pairs[kept] = pairs[n];
      kept += meets & 1;
    }
  }
  pairs.resize(kept);
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace latvox {
namespace {

HWY_EXPORT(KeepInLanes);

// Voxels and the steps between them are small, and so are all integers here.
constexpr int32_t kMostEntry = 64;

// The facets of a sum of segments are parallel to two of them [McMullen 1971].
void AddFacets(NearCells::Constants& cell, int32_t parts) {
  const std::vector<Vec3i>& steps = cell.steps;
  for (size_t r = 0; r < steps.size(); ++r) {
    for (size_t u = 0; u < r; ++u) {
      Vec3i normal = Cross(steps[r], steps[u]);
      const int32_t weight =
          std::gcd(std::gcd(normal[0], normal[1]), normal[2]) * (FirstNonzeroIsPositive(normal) ? 1 : -1);
      for (int32_t& x : normal) x /= weight;
      const auto same = [&](const NearCells::Facet& facet) { return facet.normal == normal; };
      const auto facet = std::ranges::find_if(cell.facets, same);
      const auto f = static_cast<size_t>(facet - cell.facets.begin());
      cell.weights[r][f] += std::abs(weight);
      cell.weights[u][f] += std::abs(weight);
      if (facet != cell.facets.end()) continue;
      int32_t reach = 0;
      for (const Vec3i& step : steps) reach += std::abs(Dot(normal, step));
      cell.facets.push_back({normal, reach * (kLatticeUnit / 2) / parts});
    }
  }
}

// Returns the largest x with which integers fit 32 bits if corners are at most x from the voxel, and the triangle's
// extent, too. Moments and normals then have entries up to 2 x^2.
int32_t MostFromVoxel(const NearCells::Constants& cell) {
  int64_t step = 0, reach = 0;
  for (size_t r = 0; r < cell.steps.size(); ++r) {
    step = std::max<int64_t>(step, AbsoluteSum(cell.steps[r]));
    int64_t sum = 0;
    for (size_t f = 0; f < cell.facets.size(); ++f) sum += cell.weights[r][f] * AbsoluteSum(cell.facets[f].normal);
    reach = std::max(reach, sum);
  }
  constexpr int64_t kEnd = int64_t{1} << 31;
  const auto fits = [&](int64_t x) { return step * cell.denominator * 2 * x * x < kEnd && reach * x < kEnd; };
  int32_t most = 0;
  for (int32_t bit = 1 << 15; bit != 0; bit /= 2) {
    if (fits(most + bit)) most += bit;
  }
  return most;
}

}  // namespace

std::optional<NearCells> NearCells::Of(const IntegerCell& cell) {
  NearCells out;
  auto segments = cell.Segments(kMostEntry);
  if (!segments) return std::nullopt;
  out.segments_ = *std::move(segments);

  std::vector<Frame> frames;
  bool has_frames = true;
  ForEachInCube<3>(kMaxDirection, [&](const Vec3i& q) {
    const auto meets = [&](const CellZone& zone) { return std::abs(Dot(zone.e, q)) <= 1; };
    if (!FirstNonzeroIsPositive(q) || q == Vec3i{} || !std::ranges::all_of(cell.zones(), meets)) return;
    const auto frame = MakeFrame(q);
    has_frames &= frame.has_value();
    if (!frame) return;
    frames.push_back(*frame);
    for (size_t m = 0; m < 3; ++m) out.steps_[m] = std::max(out.steps_[m], std::abs(q[m]));
  });
  if (!has_frames) return std::nullopt;
  out.frames_ = MakeScanFrames(frames);

  Constants& constants = out.constants_;
  constants.steps = out.segments_.steps;
  const int32_t common = std::gcd(kLatticeUnit / 2, out.segments_.parts);
  constants.numerator = kLatticeUnit / 2 / common;
  constants.denominator = out.segments_.parts / common;
  AddFacets(constants, out.segments_.parts);
  for (auto& weights : constants.weights) {
    for (int32_t& weight : weights) weight *= constants.numerator;
  }
  int32_t margin = 0;
  for (size_t m = 0; m < 3; ++m) {
    int32_t sum = 0;
    for (const Vec3i& step : constants.steps) sum += std::abs(step[m]);
    margin = std::max(margin, sum * (kLatticeUnit / 2) / out.segments_.parts + 2 * out.steps_[m] * kLatticeUnit);
  }
  out.most_extent_ = MostFromVoxel(constants) - margin;
  if (out.most_extent_ < 4 * kLatticeUnit) return std::nullopt;
  return out;
}

void NearCells::KeepMeeting(const SnappedMesh& mesh, const BitsLayout& layout,
                            std::vector<VoxelTriangle>& pairs) const {
  HWY_DYNAMIC_DISPATCH(KeepInLanes)(constants_, mesh, layout, pairs);
}

}  // namespace latvox
#endif  // HWY_ONCE
