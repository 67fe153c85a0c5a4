#include "core/voxelizer/unit_scan.h"

#include <algorithm>
#include <memory>
#include <span>
#include <utility>

namespace latvox {
namespace {

std::optional<BandContext> MakeBandContext(const ExactPlan& plan, StopSignal stop) {
  if (!plan.input.band) return std::nullopt;
  return BandContext{plan.input.mesh, *plan.input.band, plan.input.region, stop};
}

// Removes voxels outside of the bounds from the tiles from `first` on.
void Clip(const WorldBox& bounds, size_t first, std::vector<TileBricks>& tiles) {
  for (size_t n = first; n < tiles.size(); ++n) bounds.Clip(tiles[n]);
  std::erase_if(tiles, [](const TileBricks& tile) { return tile.bricks.empty(); });
}

}  // namespace

UnitScan::UnitScan(const ExactPlan& plan, const UnitScheduler& units, StopSignal stop)
    : plan_(plan),
      units_(units),
      context_(plan.Context(stop)),
      fields_(plan.input.mesh, plan.input.fields ? &*plan.input.fields : nullptr, plan.index.get(), stop),
      links_(plan.LinkContext(stop), plan.input.fields ? plan.input.fields->fields : FieldList{}),
      fractions_(plan.input.mesh, plan.input.fields ? &*plan.input.fields : nullptr,
                 plan.finer ? &*plan.finer : nullptr, plan.facts.fraction_labels, stop),
      band_(MakeBandContext(plan, stop)) {}

std::vector<TileBricks> UnitScan::Scan(const TileNode& unit, const Prepared& prepared) const {
  std::vector<TileBricks> tiles;
  Process(unit, prepared, tiles);
  return tiles;
}

void UnitScan::Process(const TileNode& node, const Prepared& prepared, std::vector<TileBricks>& out) const {
  if (context_.stop.Stopped() || units_.IsLeftOut(node)) return;
  if (!units_.tree().IsLeaf(node)) {
    for (const TileNode& child : units_.tree().Children(node)) Process(child, prepared, out);
    return;
  }
  const size_t first = out.size();
  ScanLeaf(node, prepared, out);
  if (plan_.input.bounds) Clip(*plan_.input.bounds, first, out);
  std::erase_if(out, [this](const TileBricks& tile) { return !units_.IsInSpan(tile.tile_ijk); });
  fields_.Add(node.triangles, prepared.interior.get(), std::span(out).subspan(first));
  links_.Add(node, std::span(out).subspan(first));
  fractions_.Add(node.triangles, prepared.interior.get(), prepared.finer.get(), std::span(out).subspan(first));
}

// A scan that was stopped in the middle of a block is not used again.
void UnitScan::ScanLeaf(const TileNode& node, const Prepared& prepared, std::vector<TileBricks>& out) const {
  if (band_) {
    std::unique_ptr<BandScan> scan = band_scans_.Reserve();
    TileBricks tile = scan->Scan(*band_, node.tile_ijk, node.triangles);
    if (!context_.stop.Stopped()) band_scans_.Release(std::move(scan));
    tile.progress = std::min(1.0, node.progress + node.share);
    if (!tile.bricks.empty()) out.push_back(std::move(tile));
    return;
  }
  if (prepared.labeled_walk != nullptr) {
    std::unique_ptr<LabeledWalkScan> scan = labeled_walk_scans_.Reserve();
    prepared.labeled_walk->FindTile(context_, node, *scan, out);
    if (!context_.stop.Stopped()) labeled_walk_scans_.Release(std::move(scan));
    return;
  }
  if (prepared.walk != nullptr) {
    std::unique_ptr<WalkScan> scan = walk_scans_.Reserve();
    prepared.walk->FindTiles(context_, node, *scan, out);
    if (!context_.stop.Stopped()) walk_scans_.Release(std::move(scan));
    return;
  }
  const Interior* const interior = prepared.interior.get();
  std::unique_ptr<BlockScan> scan = scans_.Reserve();
  if (plan_.link_ends) {
    FindLinksOfBlock(context_, node, interior, plan_.link_ends->side, *scan, out);
    if (!context_.stop.Stopped()) scans_.Release(std::move(scan));
    return;
  }
  const bool has_surface = !plan_.solid || plan_.solid->surface != SolidSurface::kNone;
  DigitizeBlock(context_, node, plan_.solid ? interior : nullptr, has_surface, *scan, out);
  if (!context_.stop.Stopped()) scans_.Release(std::move(scan));
}

}  // namespace latvox
