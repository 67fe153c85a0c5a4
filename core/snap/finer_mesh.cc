#include "core/snap/finer_mesh.h"

#include <oneapi/tbb/blocked_range.h>

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/metered.h"
#include "core/base/status_payload.h"

namespace latvox {
namespace {

using Vec3l = Vec<int64_t, 3>;

absl::Status CheckExtent(int32_t n, size_t axis, int64_t extent) {
  if (extent <= kMaxExtent) return absl::OkStatus();
  return WithField(absl::ResourceExhaustedError(absl::StrFormat(
                       "fraction_n: with %d points along each axis of a cell, the mesh extends over %d points on "
                       "lattice axis %c, the limit is %d",
                       n, extent, "ijk"[axis], kMaxExtent)),
                   "fraction_n", absl::StrCat(extent), absl::StrCat(kMaxExtent));
}

}  // namespace

// Vertices that no triangle uses are within the others' range, see Snap.
absl::StatusOr<FinerMesh> MakeFinerMesh(const SnappedMesh& mesh, int32_t n, const Vec3i& offset, StopSignal stop) {
  constexpr size_t kGrain = 4096;  // vertices for each task, or between two looks at the stop signal
  constexpr int64_t kTileUnits = int64_t{kTileSide} * kLatticeUnit;
  Vec3i low = mesh.vertices_lat[0], high = low;
  FinerMesh finer{{{}, {}, mesh.triangles, {}}, {}};
  for (size_t v = 0; v < mesh.vertices_lat.size(); ++v) {
    if (v % kGrain == 0 && stop.Stopped()) return finer;
    const Vec3i& at = mesh.vertices_lat[v];
    for (size_t m = 0; m < 3; ++m) {
      low[m] = std::min(low[m], at[m]);
      high[m] = std::max(high[m], at[m]);
    }
  }
  Vec3l move;  // of all vertices, so that the lowest lie in the first tile
  for (size_t m = 0; m < 3; ++m) {
    const int64_t first = int64_t{low[m]} * n >> kSubvoxelBits, last = int64_t{high[m]} * n >> kSubvoxelBits;
    if (absl::Status status = CheckExtent(n, m, last - first + 1); !status.ok()) return status;
    const int64_t tile = (int64_t{low[m]} * n + int64_t{offset[m]} * kLatticeUnit) / kTileUnits;
    move[m] = int64_t{offset[m]} * kLatticeUnit - tile * kTileUnits;
    finer.origin[m] = static_cast<int32_t>(move[m] / kLatticeUnit);
    finer.mesh.box.max[m] = static_cast<int32_t>((int64_t{high[m]} * n + move[m]) / kLatticeUnit + 1);
  }
  PaddedVector<Vec3i> vertices_lat(mesh.vertices_lat.size());
  MeteredFor(oneapi::tbb::blocked_range<size_t>(0, vertices_lat.size(), kGrain), [&](const auto& numbers) {
    if (stop.Stopped()) return;
    for (size_t v = numbers.begin(); v < numbers.end(); ++v) {
      for (size_t m = 0; m < 3; ++m) {
        vertices_lat[v][m] = static_cast<int32_t>(int64_t{mesh.vertices_lat[v][m]} * n + move[m]);
      }
    }
  });
  finer.mesh.vertices_lat = std::move(vertices_lat);
  return finer;
}

}  // namespace latvox
