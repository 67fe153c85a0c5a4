#include "core/voxelizer/job_facts.h"

namespace latvox {
namespace {

uint64_t TilesIn(const IndexBox& box) {
  uint64_t tiles = 1;
  for (size_t m = 0; m < 3; ++m) {
    tiles *= static_cast<uint64_t>(((box.max[m] - 1) >> kTileBits) - (box.min[m] >> kTileBits) + 1);
  }
  return tiles;
}

}  // namespace

bool HasTile(const IndexBox& box, const Vec3i& tile_ijk) {
  if (IsEmpty(box)) return false;
  for (size_t m = 0; m < 3; ++m) {
    if (tile_ijk[m] < box.min[m] >> kTileBits || tile_ijk[m] > (box.max[m] - 1) >> kTileBits) return false;
  }
  return true;
}

bool JobFacts::HasTile(const Vec3i& tile_ijk) const { return index_box && latvox::HasTile(*index_box, tile_ijk); }

JobFacts FactsOfJob(const SnappedMesh& mesh, const SurfaceFacts& surface, const IndexBox& region,
                    const std::optional<WorldBox>& bounds) {
  JobFacts facts;
  facts.triangles = mesh.triangles.size();
  facts.vertices = mesh.vertices_lat.size();
  facts.degenerate_triangles = surface.degenerate_triangles;
  facts.closed = surface.closed;
  facts.snap_error_max = kSnapErrorMax;
  for (size_t m = 0; m < 3; ++m) facts.first_tile_ijk[m] = (mesh.box.min[m] + mesh.base_ijk[m]) >> kTileBits;
  if (!IsEmpty(region)) {
    facts.index_box = IndexBox{region.min + mesh.base_ijk, region.max + mesh.base_ijk};
    facts.tiles_in_box = TilesIn(*facts.index_box);
  }
  const IndexBox whole{mesh.box.min + mesh.base_ijk, mesh.box.max + mesh.base_ijk};
  facts.cut_by_bounds = bounds && !IsEmpty(whole) && !bounds->ContainsAll(whole);
  return facts;
}

}  // namespace latvox
