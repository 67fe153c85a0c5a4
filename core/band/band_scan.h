// The band's voxels of a tile, with the squares of their distances, from the triangles around it.
#ifndef LATVOX_CORE_BAND_BAND_SCAN_H_
#define LATVOX_CORE_BAND_BAND_SCAN_H_

#include <span>
#include <vector>

#include "core/band/plan.h"
#include "core/band/triangle_distance.h"
#include "core/base/stop_signal.h"
#include "core/brick/brick.h"
#include "core/snap/snap.h"

namespace latvox {

// The facts that all tiles of a band share.
struct BandContext {
  const SnappedMesh& mesh;
  BandPlan plan;
  IndexBox region;  // local voxels outside are not delivered
  StopSignal stop;
};

// Each thread has its own, and reuses it from tile to tile: 2 MiB.
class BandScan {
 public:
  BandScan();

  // Returns the tile's bricks in lexicographic order, in global coordinates, with squares. Returns none if the tile has
  // no voxels, or once the job is cancelled.
  //   tile_ijk    local
  //   triangles   all that come within the band's reach of the tile; more do no harm. The order does not matter: each
  //               distance is a function of one triangle, and their minimum does not depend on the order
  TileBricks Scan(const BandContext& context, const Vec3i& tile_ijk, std::span<const uint32_t> triangles);

 private:
  struct Rows;
  void Add(const BandContext& context, const Triangle& corners, const IndexBox& box);
  void ScanRow(const BandContext& context, const TriangleDistance& triangle, const Rows& rows, const Vec3i& ijk,
               int32_t end);
  void Offer(const BandContext& context, const TriangleDistance& triangle, const Vec3i& ijk, double& best) const;
  Brick CutOut(const Vec3i& corner, const BandContext& context, std::vector<double>& squares) const;
  size_t NumberOf(const Vec3i& ijk) const;

  Vec3i tile_min_{};           // local
  double low_ = 0, high_ = 0;  // squares up to low_ are certainly within the limit, those from high_ on certainly not
  std::vector<double> best_;   // the smallest square so far for each voxel, in units; high_: none is within the limit
};

}  // namespace latvox

#endif  // LATVOX_CORE_BAND_BAND_SCAN_H_
