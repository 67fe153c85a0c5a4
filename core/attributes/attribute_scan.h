// The attributes of a tile's voxels, from the triangles around it.
#ifndef LATVOX_CORE_ATTRIBUTES_ATTRIBUTE_SCAN_H_
#define LATVOX_CORE_ATTRIBUTES_ATTRIBUTE_SCAN_H_

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/attributes/attributes.h"
#include "core/attributes/plan.h"
#include "core/band/triangle_distance.h"
#include "core/base/stop_signal.h"
#include "core/brick/brick.h"
#include "core/snap/snap.h"

namespace latvox {

// The facts that all tiles of a job share.
struct AttributeContext {
  const SnappedMesh& mesh;
  const CarriedAttributes carried;
  StopSignal stop;
};

// Each thread has its own, and reuses it from tile to tile: up to 8 MiB, and 60 bytes for each voxel of a tile.
class AttributeScan {
 public:
  // Finds tile.attributes as core/attributes/attributes.h defines them; some are missing once the job is cancelled.
  //   tile        voxels of a surface or a supercover, for which the plan was made
  //   triangles   all that come within the plan's reach of the tile; more do no harm. Any order
  void Find(const AttributeContext& context, std::span<const uint32_t> triangles, TileBricks& tile);

 private:
  static constexpr size_t kRows = size_t{kTileSide} * kTileSide;
  static constexpr size_t kMostOffers = size_t{1} << 18;  // and those of one triangle

  // A triangle that may be the nearest to a voxel. Offers of one voxel form a list, the last one first.
  struct Offer {
    double square;  // of the distance, units, as TriangleDistance::SquareTo
    uint32_t triangle;
    uint32_t before;  // in offers_, or kNone
  };

  // The smallest values among the corners of a triangle that are nearest to a point.
  struct Corner {
    __int128 square;  // of the distance, as of Inner
    std::array<uint32_t, kMaxAttributes> values;
  };

  struct Candidate {
    uint32_t triangle;
    Corner corner;
  };

  void Number(const TileBricks& tile, const Vec3i& base_ijk, double most);
  size_t NumberOf(const Vec3i& at) const;
  void Add(const AttributeContext& context, uint32_t number);
  void Compare(const TriangleDistance& triangle, uint32_t number, const Vec3i& point, size_t voxel);
  void Settle(const AttributeContext& context);
  template <class F>
  void ForEachCandidate(const AttributeContext& context, const Vec3i& point, size_t voxel, F&& f) const;
  Corner Decide(const AttributeContext& context, const Vec3i& point, size_t voxel) const;
  static Corner NearestCorner(const AttributeContext& context, uint32_t number, const Vec3i& point);
  Candidate Nearest(const AttributeContext& context, const Vec3i& point, size_t voxel) const;
  void CutOut(const AttributeContext& context, TileBricks& tile);

  Vec3i tile_min_{};                     // local
  std::array<uint64_t, kRows> rows_{};   // the tile's voxels: bit k of rows_[i << 6 | j]
  std::array<uint32_t, kRows> first_{};  // the number of a row's first voxel
  std::vector<double> least_;            // by the voxels' numbers: the smallest square so far
  std::vector<uint32_t> last_;           // by the voxels' numbers: the last offer, or kNone
  std::vector<Offer> offers_;
  // By the voxels' numbers, if there are any: the nearest of earlier, dropped offers, or kNone.
  std::vector<Candidate> settled_;
};

}  // namespace latvox

#endif  // LATVOX_CORE_ATTRIBUTES_ATTRIBUTE_SCAN_H_
