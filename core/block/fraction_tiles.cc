#include "core/block/fraction_tiles.h"

#include <algorithm>
#include <memory>
#include <utility>

namespace latvox {
namespace {

// Keeps the triangles with bounding boxes that meet the box around the lattice points of a tile.
void KeepNear(const SnappedMesh& mesh, const Vec3i& tile_ijk, std::span<const uint32_t> triangles,
              std::vector<uint32_t>& near) {
  constexpr int32_t kLast = (kTileSide - 1) * kLatticeUnit;
  const Vec3i low = tile_ijk * (kTileSide * kLatticeUnit);
  near.clear();
  for (const uint32_t t : triangles) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Vec3i &va = mesh.vertices_lat[a], &vb = mesh.vertices_lat[b], &vc = mesh.vertices_lat[c];
    bool meets = true;
    for (size_t m = 0; m < 3; ++m) {
      const auto [least, most] = std::minmax({va[m], vb[m], vc[m]});
      meets &= least <= low[m] + kLast && most >= low[m];
    }
    if (meets) near.push_back(t);
  }
}

}  // namespace

Vec3i ReachOf(const CellPoints& cell) {
  Vec3i reach;
  for (size_t m = 0; m < 3; ++m) reach[m] = (std::max(-cell.low[m], cell.high[m]) + cell.n - 1) / cell.n;
  return reach;
}

IndexBox FinerPointsOf(const CellPoints& cell, const FinerMesh& finer, const IndexBox& region) {
  const Vec3i low = finer.origin + cell.low, high = finer.origin + cell.high;
  return {region.min * cell.n + low, (region.max - Vec3i{1, 1, 1}) * cell.n + high + Vec3i{1, 1, 1}};
}

size_t FractionTiles::Scan::Bytes() const {
  size_t bytes = BytesOf(triangles);
  for (const Points* points : {&voxels, &finer}) bytes += points->all.Bytes() + points->of_labels.Bytes();
  for (const FractionTable& table : tables) bytes += sizeof(table) + table.Bytes();
  return bytes;
}

FractionTiles::FractionTiles(const SnappedMesh& mesh, const FieldPlan* plan, const FinerMesh* finer,
                             std::span<const uint32_t> labels, StopSignal stop)
    : mesh_(mesh), plan_(plan), finer_(finer), labels_(labels), stop_(stop) {
  if (finer == nullptr) return;
  for (size_t place = 0; place < plan->fields.size(); ++place) {
    const Field field = plan->fields.view()[place];
    if (field == Field::kFraction) columns_.push_back({place, std::nullopt});
    if (field != Field::kLabelFractions) continue;
    for (size_t label = 0; label < labels.size(); ++label) columns_.push_back({place, label});
  }
}

void FractionTiles::Find(const Interior& interior, const Vec3i& tile_ijk, std::span<const uint32_t> triangles,
                         Points& points) const {
  interior.Find(tile_ijk, triangles, points.all);
  if (!labels_.empty() && !stop_.Stopped()) points.of_labels.Set(labels_, points.all.labels());
}

// A cell lies within `high - low` of each of its points. So if no triangle comes that near to a finer tile, all cells
// with points in it lie on the side of their voxels. Only tiles with triangles that near are counted.
void FractionTiles::Add(std::span<const uint32_t> triangles, const Interior* interior, const Interior* finer,
                        std::span<TileBricks> tiles) const {
  if (finer_ == nullptr || tiles.empty()) return;
  const CellPoints& cell = *plan_->cell;
  const Vec3i margin = cell.high - cell.low;
  std::unique_ptr<Scan> scan = scans_.Reserve();
  for (TileBricks& tile : tiles) {
    if (stop_.Stopped()) return;
    const Vec3i tile_min = tile.tile_ijk * kTileSide - mesh_.base_ijk;
    Find(*interior, Shifted(tile_min, kTileBits), triangles, scan->voxels);
    if (stop_.Stopped()) return;
    tile.fields.resize(plan_->fields.size());
    scan->tables.resize(columns_.size());
    for (size_t n = 0; n < columns_.size(); ++n) {
      const Column& column = columns_[n];
      scan->tables[n].Begin(cell, finer_->origin + tile_min * cell.n, scan->voxels.Of(column), tile,
                            {tile.fields[column.place], column.label.value_or(0), column.label ? labels_.size() : 1});
    }
    if (triangles.empty()) continue;
    const IndexBox around = scan->tables[0].Around();
    const TileTree tree(finer_->mesh, 0, margin, margin, around, stop_);
    AddNode(tree,
            {Shifted(around.min, kTileBits), TileCubeLevel(around), {triangles.begin(), triangles.end()}, {}, 0, 1},
            *finer, *scan);
  }
  if (!stop_.Stopped()) scans_.Release(std::move(scan));
}

void FractionTiles::AddNode(const TileTree& tree, const TileNode& node, const Interior& finer, Scan& scan) const {
  const Vec3i low = node.tile_ijk * kTileSide;
  if (stop_.Stopped() || !scan.tables[0].Meets(low, node.level)) return;
  if (!tree.IsLeaf(node)) {
    for (const TileNode& child : tree.Children(node)) AddNode(tree, child, finer, scan);
    return;
  }
  KeepNear(finer_->mesh, node.tile_ijk, node.triangles, scan.triangles);
  Find(finer, node.tile_ijk, scan.triangles, scan.finer);
  if (stop_.Stopped()) return;
  for (size_t n = 0; n < columns_.size(); ++n) {
    const Column& column = columns_[n];
    if (scan.voxels.Has(column) || scan.finer.Has(column)) scan.tables[n].Add(low, scan.finer.Of(column));
  }
}

}  // namespace latvox
