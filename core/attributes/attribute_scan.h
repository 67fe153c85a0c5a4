// The attributes of a tile's voxels, from the triangles around it.
#ifndef LATVOX_CORE_ATTRIBUTES_ATTRIBUTE_SCAN_H_
#define LATVOX_CORE_ATTRIBUTES_ATTRIBUTE_SCAN_H_

#include <array>
#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "core/attributes/plan.h"
#include "core/band/triangle_distance.h"
#include "core/snap/snap.h"
#include "core/tile/brick.h"

namespace latvox {

// What all tiles of a job have in common.
struct AttributeContext {
  const SnappedMesh& mesh;
  const CarriedAttributes carried;
  const std::atomic<bool>& cancelled;
};

// A thread's own, from tile to tile: 48 KiB, and 48 bytes for each voxel of a tile.
class AttributeScan {
 public:
  // Finds tile.attributes, as core/attributes/attributes.h has them; some are missing once the job is cancelled.
  //   tile        voxels of a surface or a supercover, for which the plan was made
  //   triangles   all that come within the plan's reach of the tile; more do no harm. Any order
  void Find(const AttributeContext& context, std::span<const uint32_t> triangles, TileBricks& tile);

 private:
  static constexpr size_t kRows = size_t{kTileSide} * kTileSide;

  // What is known of a voxel.
  struct Nearest {
    double square;           // of the distance to the nearest triangles so far, units, as TriangleDistance::SquareTo
    __int128 corner_square;  // of that to the nearest of their corners, as of Inner
    uint32_t triangle;       // one of these triangles, or kNone
  };

  void Number(const TileBricks& tile, const Vec3i& base_ijk, double most);
  void Add(const AttributeContext& context, uint32_t number);
  void Offer(const AttributeContext& context, uint32_t number, const TriangleDistance& triangle, const Vec3i& point,
             size_t voxel);
  void OfferCorners(const AttributeContext& context, uint32_t number, const Vec3i& point, size_t voxel);
  void CutOut(uint32_t count, TileBricks& tile) const;

  Vec3i tile_min_{};                     // local
  std::array<uint64_t, kRows> rows_{};   // the tile's voxels: bit k of rows_[i << 6 | j]
  std::array<uint32_t, kRows> first_{};  // the number of a row's first voxel
  std::vector<Nearest> nearest_;         // by the voxels' numbers
  std::vector<uint32_t> values_;         // likewise, as many for each as there are attributes
};

}  // namespace latvox

#endif  // LATVOX_CORE_ATTRIBUTES_ATTRIBUTE_SCAN_H_
