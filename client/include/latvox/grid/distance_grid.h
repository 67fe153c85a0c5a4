// Bands of distances as OpenVDB grids. No OpenVDB header is needed to use this.
//
//   index space, world space, metadata   as latvox/grid/voxel_grid.h has them, and latvox_band_width,
//                                        latvox_band_signed, latvox_band_digest
//   active voxels                        the band
//   values                               the distances, world units; the width (the background) elsewhere
//
// A signed band of a whole mesh, as wide as each basis vector is long or wider, is a level set: OpenVDB's class says
// so, and what lies inside beyond the band has the value -width.
#ifndef LATVOX_LATVOX_GRID_DISTANCE_GRID_H_
#define LATVOX_LATVOX_GRID_DISTANCE_GRID_H_

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "latvox/export.h"
#include "latvox/types.h"

namespace latvox::client {

// A grid being filled: a FloatGrid named "distance". Not thread-safe. Memory: about 2.5 KB for each brick.
class LATVOX_EXPORT DistanceGrid {
 public:
  //   width   world units
  //   whole   nothing of the mesh is left out by a region, bounds or a shard
  // Precondition: CheckGridTransform(transform) is OK.
  DistanceGrid(const GridTransform& transform, double width, bool is_signed, bool whole);
  DistanceGrid(DistanceGrid&&) noexcept;             // the other one may then be destroyed or assigned to, no more
  DistanceGrid& operator=(DistanceGrid&&) noexcept;  // as if the one before were destroyed
  ~DistanceGrid();                                   // frees the grid

  // Adds the batch's voxels. Precondition: it has a value for each. Errors: RESOURCE_EXHAUSTED (memory).
  absl::Status Add(const BrickBatch& batch);

  // Writes into the grid's metadata what was asked for: latvox_request, a JSON object with the fields of a line of
  // `latvox batch`, and latvox_region and latvox_bounds of a request for these. With what is noted of the mesh, such a
  // line and the same mesh repeat the whole.
  void SetRequest(const VoxelizeRequest& request, const MeshNote& note = {});

  // Writes the certificate into the grid's metadata.
  void SetCertificate(const Certificate& certificate);

  // Writes a .vdb file to `path`, over what is there; not atomic. Errors: UNKNOWN, with the path and OpenVDB's words.
  absl::Status Write(const std::string& path);

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_GRID_DISTANCE_GRID_H_
