#include "core/block/surface_scan.h"

#include <algorithm>
#include <iterator>

#include "core/base/bytes_of.h"

namespace latvox {

ScannedSurface SurfaceScan::Scan(const TileContext& context, const TileNode& node, int32_t halo,
                                 std::span<const uint32_t> triangles) {
  voxels_.Reset(BlockBox(context, node, halo));
  candidates_.Reset({}, context.frames);
  rim_only_.clear();
  voxels_.where().ForEachTinyBatch(context, [this](const Crossings& some) { voxels_.Add(some.nearer.view()); });
  if (context.supercover != nullptr) {
    cover_.Add(context, triangles, candidates_, memory_, voxels_);
    return {voxels_, candidates_, rim_only_, memory_};
  }
  candidates_.Reset(context.is_tiny.empty() ? triangles : WithoutTiny(context, triangles), context.frames);
  if (!context.stop.Stopped()) {
    candidates_.ForEach(context, voxels_.where(), [&](const Candidates& candidates) {
      voxels_.Add(candidates.nearer.view());
      AddRim(context, candidates);
    });
  }
  return {voxels_, candidates_, rim_only_, memory_};
}

std::span<const uint32_t> SurfaceScan::WithoutTiny(const TileContext& context, std::span<const uint32_t> triangles) {
  others_.clear();
  std::copy_if(triangles.begin(), triangles.end(), std::back_inserter(others_),
               [&](uint32_t t) { return context.is_tiny[t] == 0; });
  return others_;
}

// Neighboring triangles have already set most candidates of a triangle's rim.
void SurfaceScan::AddRim(const TileContext& context, const Candidates& candidates) {
  if (context.stop.Stopped()) return;
  TileBits& surface = voxels_.bits();
  surface.Find(candidates.rim.view(), false, memory_.positions);
  FindPairs(candidates, candidates.rim, memory_.positions, &Candidates::Run::rim_end, context.stop, memory_.pairs);
  added_.clear();
  const auto is_new = [&](uint32_t voxel) { return !surface.Test(voxel); };
  ForEachStar(context, voxels_.where().layout, memory_.pairs, is_new, [&](uint32_t voxel, const StarLinks& star) {
    if (star.nearer == 0 || surface.Test(voxel)) return;
    surface.Set(voxel);
    added_.push_back(voxel);
    rim_only_.push_back({voxel, star});
  });
  voxels_.MarkDirty(added_);
}

size_t SurfaceScan::Bytes() const {
  return voxels_.Bytes() + BytesOf(others_) + candidates_.Bytes() + cover_.Bytes() + BytesOf(rim_only_) +
         memory_.Bytes() + BytesOf(added_);
}

}  // namespace latvox
