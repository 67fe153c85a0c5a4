#include "core/block/cover_scan.h"

#include <hwy/base.h>
#include <hwy/cache_control.h>

#include <algorithm>
#include <utility>

#include "core/digitize/cell_box.h"
#include "core/supercover/box_cells.h"
#include "core/supercover/near_cells.h"

namespace latvox {
namespace {

// A triangle whose box has so many cells is small: its cells are tested one by one.
constexpr int32_t kFewCells = 8;
static_assert(kFewCells <= kSmallCells);

bool IsSmall(const Vec3i& side) {
  return int64_t{side[0]} * side[1] <= kFewCells && side[0] * side[1] * side[2] <= kFewCells;
}

// Calls f(number) for the voxels of a box.
template <class F>
HWY_INLINE void ForEachNumber(const BitsLayout& layout, const IndexBox& box, F&& f) {
  const Vec3i side = box.max - box.min;
  uint32_t plane = layout.NumberOf(box.min);
  for (int32_t i = 0; i < side[0]; ++i, plane += static_cast<uint32_t>(layout.stride[0])) {
    uint32_t row = plane;
    for (int32_t j = 0; j < side[1]; ++j, row += static_cast<uint32_t>(layout.stride[1])) {
      for (int32_t k = 0; k < side[2]; ++k) f(row + static_cast<uint32_t>(k));
    }
  }
}

// Prefetches the corners of later triangles. Neighbors in the list may be far apart in the mesh, and so may their
// vertices.
HWY_INLINE void PrefetchAhead(const SnappedMesh& mesh, std::span<const uint32_t> triangles) {
  constexpr size_t kVerticesAhead = 12, kTrianglesAhead = 24;
  if (triangles.size() <= kTrianglesAhead) return;
  hwy::Prefetch(&mesh.triangles[triangles[kTrianglesAhead]]);
  for (const uint32_t vertex : mesh.triangles[triangles[kVerticesAhead]]) hwy::Prefetch(&mesh.vertices_lat[vertex]);
}

}  // namespace

// A row of cells along an axis meets the triangle in each of its cells, because the triangle is connected.
HWY_INLINE void CoverScan::AddSmall(uint32_t t, const IndexBox& cells, const Triangle& triangle, BlockVoxels& voxels) {
  const BlockBox& where = voxels.where();
  TileBits& bits = voxels.bits();
  const IndexBox within = Intersection(cells, where.box);
  covered_.Add({where.layout.NumberOf(within.min), where.layout.NumberOf(within.max - Vec3i{1, 1, 1})});
  const Vec3i side = cells.max - cells.min;
  if ((side[0] > 1 ? 1 : 0) + (side[1] > 1 ? 1 : 0) + (side[2] > 1 ? 1 : 0) <= 1) {
    return ForEachNumber(where.layout, within, [&](uint32_t number) { bits.Set(number); });
  }
  for (const Vec3i& corner : triangle) {
    const Vec3i nearest = Shifted(corner + Vec3i{1, 1, 1} * (kLatticeUnit / 2), kSubvoxelBits);
    if (where.box.Contains(nearest)) bits.Set(where.layout.NumberOf(nearest));
  }
  ForEachNumber(where.layout, within, [&](uint32_t number) {
    if (!bits.Test(number)) open_.push_back({number, t});
  });
}

void CoverScan::Add(const TileContext& context, std::span<const uint32_t> triangles, CandidateParts& candidates,
                    PairMemory& memory, BlockVoxels& voxels) {
  covered_ = {};
  if (!context.supercover->scan_frames().empty()) {
    AddBoxes(context, triangles, candidates, memory, voxels);
  } else if (context.supercover->near_cells() != nullptr) {
    AddNearCells(context, triangles, memory, voxels);
  } else {
    for (const uint32_t t : triangles) {
      if (context.stop.Stopped()) break;
      AddRows(context, context.mesh.TriangleAt(t), voxels);
    }
  }
  voxels.MarkPlanesDirty(covered_);
}

void CoverScan::AddBoxes(const TileContext& context, std::span<const uint32_t> triangles, CandidateParts& candidates,
                         PairMemory& memory, BlockVoxels& voxels) {
  const std::vector<ScanFrame>& frames = context.supercover->scan_frames();
  const BlockBox& where = voxels.where();
  const auto keep_in_box = [&](std::vector<VoxelTriangle>& pairs) {
    KeepMeeting(context.mesh, where.layout, false, pairs);
  };
  const auto keep_of_rim = [&](std::vector<VoxelTriangle>& pairs) {
    KeepMeeting(context.mesh, where.layout, true, pairs);
  };
  scanned_.clear();
  open_.clear();
  constexpr size_t kMostOpen = size_t{1} << 16;
  for (size_t n = 0; n < triangles.size() && !context.stop.Stopped(); ++n) {
    PrefetchAhead(context.mesh, triangles.subspan(n));
    const uint32_t t = triangles[n];
    const Triangle triangle = context.mesh.TriangleAt(t);
    const IndexBox cells = BoxOfCells(triangle);
    if (IsEmpty(Intersection(cells, where.box))) continue;
    if (IsSmall(cells.max - cells.min)) {
      AddSmall(t, cells, triangle, voxels);
      if (open_.size() > kMostOpen) AddMeeting(context, std::exchange(open_, {}), keep_in_box, voxels);
    } else if (ScanFindsCover(triangle)) {
      scanned_.push_back(t);
    } else {
      AddRows(context, triangle, voxels);
    }
  }
  candidates.Reset(scanned_, frames);
  if (!scanned_.empty() && !context.stop.Stopped()) {
    candidates.ForEach(context, where, [&](const Candidates& some) {
      voxels.Add(some.nearer.view());
      voxels.bits().Find(some.rim.view(), false, memory.positions);
      FindPairs(some, some.rim, memory.positions, &Candidates::Run::rim_end, context.stop, memory.pairs);
      AddMeeting(context, memory.pairs, keep_of_rim, voxels);
    });
  }
  AddMeeting(context, open_, keep_in_box, voxels);
}

void CoverScan::AddNearCells(const TileContext& context, std::span<const uint32_t> triangles, PairMemory& memory,
                             BlockVoxels& voxels) {
  constexpr size_t kEnough = size_t{1} << 18;
  const NearCells& cells = *context.supercover->near_cells();
  const CoverShape shape{cells.frames(), cells.segments(), cells.most_extent()};
  const BlockBox& where = voxels.where();
  const auto keep = [&](std::vector<VoxelTriangle>& pairs) { cells.KeepMeeting(context.mesh, where.layout, pairs); };
  const auto add = [&](const NumberList& list, uint32_t Candidates::Run::*end) {
    voxels.bits().Find(list.view(), false, memory.positions);
    FindPairs(lines_, list, memory.positions, end, context.stop, memory.pairs);
    AddMeeting(context, memory.pairs, keep, voxels);
  };
  const SearchLimits limits{where.box, where.layout, context.stop, kEnough};
  for (size_t done = 0; done < triangles.size() && !context.stop.Stopped();) {
    lines_.Clear();
    left_.clear();
    done += FindCoverCandidates(context.mesh, triangles.subspan(done), shape, limits, lines_, left_);
    voxels.Add(lines_.nearer.view());
    for (const uint32_t t : left_) {
      if (context.stop.Stopped()) break;
      AddRows(context, context.mesh.TriangleAt(t), voxels);
    }
    add(lines_.rim, &Candidates::Run::rim_end);
    add(lines_.farther, &Candidates::Run::crossed_end);
  }
}

void CoverScan::AddRows(const TileContext& context, const Triangle& triangle, BlockVoxels& voxels) {
  const BlockBox& where = voxels.where();
  context.supercover->ForEachRun(triangle, where.box, [&](const Vec3i& first, int32_t count) {
    const uint32_t number = where.layout.NumberOf(first), size = static_cast<uint32_t>(count);
    covered_.Add({number, number + size - 1});
    voxels.bits().SetRun(number, size);
  });
}

// Adds each voxel whose cell meets the triangle of its pair. Later batches skip voxels that earlier ones have found.
template <class Keep>
void CoverScan::AddMeeting(const TileContext& context, std::span<const VoxelTriangle> pairs, const Keep& keep,
                           BlockVoxels& voxels) {
  constexpr size_t kBatch = 256;
  TileBits& bits = voxels.bits();
  for (size_t n = 0; n < pairs.size() && !context.stop.Stopped();) {
    batch_.clear();
    for (; n < pairs.size() && batch_.size() < kBatch; ++n) {
      if (!bits.Test(pairs[n].voxel)) batch_.push_back(pairs[n]);
    }
    keep(batch_);
    for (const VoxelTriangle& pair : batch_) {
      covered_.Add({pair.voxel, pair.voxel});
      bits.Set(pair.voxel);
    }
  }
}

}  // namespace latvox
