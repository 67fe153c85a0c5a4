#include "core/block/link_tiles.h"

#include <bit>
#include <memory>
#include <utility>

namespace latvox {

void LinkTiles::Add(const TileNode& node, std::span<TileBricks> tiles) const {
  if (tiles.empty() || fields_.OfLinks().empty()) return;
  std::unique_ptr<Scan> scan = scans_.Reserve();
  scan->links.Begin(context_, node, node.triangles);
  const BlockBox& where = scan->links.where();
  scan->table.Begin(fields_, order_.neighbors, where.block, context_.mesh, tiles);
  scan->links.ForEachStar(
      context_, [&](const VoxelTriangle& pair, const StarLinks& star) { AddStar(scan->table, where, pair, star); });
  if (!context_.stop.Stopped()) scans_.Release(std::move(scan));
}

void LinkTiles::AddStar(const LinkTable& table, const BlockBox& where, const VoxelTriangle& pair,
                        const StarLinks& star) const {
  const Vec3i z = where.layout.VoxelAt(pair.voxel);
  const LinkTable::Row row = table.RowOf(z);
  const OrientedTriangle triangle(context_.mesh.TriangleAt(pair.triangle));
  const SharesAt shares(triangle, z);
  for (uint32_t links = star.nearer; links != 0; links &= links - 1) {
    const auto n = static_cast<size_t>(std::countr_zero(links));
    const bool forward = (star.forward >> n & 1) != 0;
    const Vec3i& along = context_.frames[n].frame.q;
    const Vec3i q = forward ? along : -along;
    const size_t place = forward ? order_.places[n] : order_.Opposite(order_.places[n]);
    const LinkShare share = shares.Along(q);
    if (!row.empty()) table.Add(row, place, {z, q, pair.triangle, share});
    const LinkTable::Row other = table.RowOf(z + q);
    if (!other.empty()) table.Add(other, order_.Opposite(place), {z + q, -q, pair.triangle, share.FromOtherEnd()});
  }
}

}  // namespace latvox
