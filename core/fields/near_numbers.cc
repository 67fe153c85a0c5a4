// A kernel finds which cells the boxes of triangles come near, with axes in lanes.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/fields/near_numbers.cc"
#include "core/fields/near_numbers.h"

#include <hwy/foreach_target.h>  // must come before highway.h
#include <hwy/highway.h>

#include <algorithm>

// The code that does not depend on the instruction set, once.
#ifndef LATVOX_CORE_FIELDS_NEAR_NUMBERS_ONCE_
#define LATVOX_CORE_FIELDS_NEAR_NUMBERS_ONCE_

namespace latvox {
namespace {

constexpr int32_t kCells = 8;                  // along a side of the cube
constexpr size_t kBlock = 128;                 // triangles at a time
constexpr uint32_t kNowhere = ~0U;             // the cells of a triangle that comes near none
constexpr int kAxisShift = 6, kLastShift = 3;  // first and last cell along an axis, three bits each

struct CubeOfCells {
  Vec3i origin, reach;  // units
  int bits;             // log2 of a cell's side in units
};

// The cells of each triangle.
using CellsOfBlock = std::array<uint32_t, kBlock>;

void PlainCells(const CubeOfCells& cube, const SnappedMesh& mesh, std::span<const uint32_t> triangles,
                CellsOfBlock& out) {
  for (size_t n = 0; n < triangles.size(); ++n) {
    const auto& [a, b, c] = mesh.triangles[triangles[n]];
    const Vec3i &u = mesh.vertices_lat[a], &v = mesh.vertices_lat[b], &w = mesh.vertices_lat[c];
    uint32_t cells = 0;
    bool is_near = true;
    for (size_t m = 0; m < 3; ++m) {
      const int32_t least = std::min(std::min(u[m], v[m]), w[m]) - cube.origin[m];
      const int32_t most = std::max(std::max(u[m], v[m]), w[m]) - cube.origin[m];
      const int32_t first = std::max((least - cube.reach[m] + kLatticeUnit - 1) >> cube.bits, 0);
      const int32_t last = std::min((most + cube.reach[m]) >> cube.bits, kCells - 1);
      is_near &= first <= last;
      cells |= static_cast<uint32_t>(first | last << kLastShift) << (kAxisShift * static_cast<int>(m));
    }
    out[n] = is_near ? cells : kNowhere;
  }
}

}  // namespace
}  // namespace latvox

#endif  // LATVOX_CORE_FIELDS_NEAR_NUMBERS_ONCE_

HWY_BEFORE_NAMESPACE();
namespace latvox {
namespace HWY_NAMESPACE {
namespace {

#if HWY_TARGET == HWY_SCALAR  // which has no vectors of four

void Cells(const CubeOfCells& cube, const SnappedMesh& mesh, std::span<const uint32_t> triangles, CellsOfBlock& out) {
  PlainCells(cube, mesh, triangles, out);
}

#else

namespace hn = hwy::HWY_NAMESPACE;

// Vertices are padded, so a vector of four may be read; the fourth lane is meaningless.
void Cells(const CubeOfCells& cube, const SnappedMesh& mesh, std::span<const uint32_t> triangles, CellsOfBlock& out) {
  const hn::FixedTag<int32_t, 4> d;
  const auto vector = [&](const Vec3i& v) HWY_ATTR {
    const int32_t lanes[] = {v[0], v[1], v[2], 0};
    return hn::LoadU(d, lanes);
  };
  constexpr int32_t kUp = kLatticeUnit - 1;
  const auto below = vector(Vec3i{kUp, kUp, kUp} - cube.reach - cube.origin), above = vector(cube.reach - cube.origin);
  const auto highest = hn::Set(d, kCells - 1);
  const auto corner = [&](uint32_t vertex) HWY_ATTR { return hn::LoadU(d, mesh.vertices_lat[vertex].data()); };
  for (size_t n = 0; n < triangles.size(); ++n) {
    const auto& [a, b, c] = mesh.triangles[triangles[n]];
    const auto u = corner(a), v = corner(b), w = corner(c);
    const auto least = hn::Add(hn::Min(hn::Min(u, v), w), below), most = hn::Add(hn::Max(hn::Max(u, v), w), above);
    const auto first = hn::Max(hn::ShiftRightSame(least, cube.bits), hn::Zero(d));
    const auto last = hn::Min(hn::ShiftRightSame(most, cube.bits), highest);
    const auto none = hn::BroadcastSignBit(hn::Sub(last, first));
    alignas(16) int32_t of_axis[4];
    hn::Store(hn::Or(none, hn::Or(first, hn::ShiftLeft<kLastShift>(last))), d, of_axis);
    const int32_t cells = of_axis[0] | of_axis[1] << kAxisShift | of_axis[2] << 2 * kAxisShift;
    out[n] = (of_axis[0] | of_axis[1] | of_axis[2]) < 0 ? kNowhere : static_cast<uint32_t>(cells);
  }
}

#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace latvox
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <iterator>

#include "core/base/simd.h"

namespace latvox {

HWY_EXPORT(Cells);

namespace {

int32_t FirstOf(uint32_t cells, int axis) { return static_cast<int32_t>(cells >> (kAxisShift * axis) & 7); }
int32_t LastOf(uint32_t cells, int axis) { return static_cast<int32_t>(cells >> (kAxisShift * axis + kLastShift) & 7); }

uint32_t SlabsOf(uint32_t cells) {
  uint32_t slabs = 0;
  for (int m = 0; m < 3; ++m) slabs |= ((2U << LastOf(cells, m)) - (1U << FirstOf(cells, m))) << (m * kCells);
  return slabs;
}

}  // namespace

// Small triangles that follow each other mostly are of one kind, and near the same cells. Only the first of them is
// marked.
void NearNumbers::Begin(const SnappedMesh& mesh, const FieldPlan& plan, std::span<const uint32_t> triangles,
                        const Vec3i& low, StopSignal stop) {
  static_assert(kSide == kCells);
  const CubeOfCells cube{low * kLatticeUnit, *plan.near_reach, kSubvoxelBits + cell_bits_};
  numbers_ = plan.of_vertices.data();
  count_ = plan.of_mesh.size();
  triangles_ = triangles;
  rows_.fill({});
  kinds_.clear();
  last_kind_ = kMixed;
  of_row_ = {-1, -1};
  all_.clear();
  all_.reserve(triangles.size());
  CellsOfBlock cells;
  Marked marked{.cells = kNowhere};
  for (size_t block = 0; block < triangles.size(); block += kBlock) {
    if (stop.Stopped()) return;
    const std::span<const uint32_t> some = triangles.subspan(block, std::min(kBlock, triangles.size() - block));
    if (SimdIsScalar()) {
      PlainCells(cube, mesh, some, cells);
    } else {
      HWY_DYNAMIC_DISPATCH(Cells)(cube, mesh, some, cells);
    }
    for (size_t n = 0; n < some.size(); ++n) {
      if (cells[n] == kNowhere) continue;
      const std::array<uint32_t, 3>& corners = mesh.triangles[some[n]];
      const bool is_same = cells[n] == marked.cells && HasNumbers(corners, marked.numbers);
      if (!is_same) marked = Mark(cells[n], KindOf(corners));
      AddToRun(marked.slabs, static_cast<uint32_t>(block + n));
    }
  }
}

inline void NearNumbers::AddToRun(uint32_t slabs, uint32_t place) {
  if (!all_.empty()) {
    Run& last = all_.back();
    const uint32_t more = place - last.first;
    if (last.slabs_and_more == (slabs | (more - 1) << kMoreShift) && more <= kMostMore) {
      last.slabs_and_more += 1U << kMoreShift;
      return;
    }
  }
  all_.push_back({slabs, place});
}

// Marks that triangles of a kind come near these cells.
NearNumbers::Marked NearNumbers::Mark(uint32_t cells, uint8_t kind) {
  const int32_t first = FirstOf(cells, 2), last = LastOf(cells, 2);
  const uint64_t of_row = (~uint64_t{0} >> 8 * (kSide - 1 - last + first)) << 8 * first;
  const uint64_t kinds = of_row & kind * uint64_t{0x0101010101010101};
  for (int32_t i = FirstOf(cells, 0); i <= LastOf(cells, 0); ++i) {
    for (int32_t j = FirstOf(cells, 1); j <= LastOf(cells, 1); ++j) {
      Row& row = rows_[RowOf(i, j)];
      row.any |= kinds;
      row.all &= kind == kMixed ? ~of_row : kinds | ~of_row;
    }
  }
  return {cells, SlabsOf(cells), kind == kMixed ? nullptr : &numbers_[kinds_[kind - size_t{1}] * count_]};
}

// Whether all corners have these numbers, if these are not null.
inline bool NearNumbers::HasNumbers(const std::array<uint32_t, 3>& corners, const uint32_t* numbers) const {
  if (numbers == nullptr) return false;
  return std::ranges::all_of(corners, [&](uint32_t vertex) {
    const uint32_t* const of_vertex = &numbers_[vertex * count_];
    return of_vertex[0] == numbers[0] && (count_ == 1 || std::equal(of_vertex + 1, of_vertex + count_, numbers + 1));
  });
}

// Neighbors in the list of triangles mostly are of one kind.
uint8_t NearNumbers::KindOf(const std::array<uint32_t, 3>& corners) {
  if (last_kind_ != kMixed && HasNumbers(corners, &numbers_[kinds_[last_kind_ - size_t{1}] * count_]))
    return last_kind_;
  return last_kind_ = NewKind(corners);
}

uint8_t NearNumbers::NewKind(const std::array<uint32_t, 3>& corners) {
  const uint32_t a = corners[0];
  if (!AreEqual(a, corners[1]) || !AreEqual(a, corners[2])) return kMixed;
  const auto known = std::ranges::find_if(kinds_, [&](uint32_t vertex) { return AreEqual(a, vertex); });
  if (known != kinds_.end()) return static_cast<uint8_t>(known - kinds_.begin() + 1);
  if (kinds_.size() == kMostKinds) return kMixed;
  kinds_.push_back(a);
  return static_cast<uint8_t>(kinds_.size());
}

void NearNumbers::Keep(const std::vector<Run>& from, int slab, std::vector<Run>& kept) {
  kept.clear();
  kept.reserve(from.size());
  std::ranges::copy_if(from, std::back_inserter(kept),
                       [slab](const Run& run) { return (run.slabs_and_more >> slab & 1) != 0; });
}

std::span<const uint32_t> NearNumbers::TrianglesNear(const Vec3i& cell) {
  if (cell[0] != of_row_[0]) {
    Keep(all_, cell[0], slab_);
    of_row_ = {cell[0], -1};
  }
  if (cell[1] != of_row_[1]) {
    Keep(slab_, kSide + cell[1], row_);
    of_row_[1] = cell[1];
  }
  near_.clear();
  for (const Run& run : row_) {
    if ((run.slabs_and_more >> (2 * kSide + cell[2]) & 1) == 0) continue;
    const auto first = triangles_.begin() + run.first;
    near_.insert(near_.end(), first, first + (run.slabs_and_more >> kMoreShift) + 1);
  }
  return near_;
}

}  // namespace latvox

#endif  // HWY_ONCE
