// Bands with their distances, and no other fields, as OpenVDB grids. Programs need no OpenVDB header for this.
//
//   index space, world space, metadata   as in latvox/grid/voxel_grid.h, and latvox_band_width,
//                                        latvox_signed_distance, latvox_distance_digest
//   active voxels                        the band
//   values                               the distances, world units; the width (the background) elsewhere
//
// A signed band of a whole mesh is a level set if it is at least as wide as each basis vector is long. Then OpenVDB's
// grid class says so, and points inside beyond the band have the value -width.
#ifndef LATVOX_LATVOX_GRID_DISTANCE_GRID_H_
#define LATVOX_LATVOX_GRID_DISTANCE_GRID_H_

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "latvox/cancellation.h"
#include "latvox/export.h"
#include "latvox/types.h"

namespace latvox::client {

// A grid that is being filled: a FloatGrid named "distance". Not thread-safe. Memory: about 2.5 KB for each brick.
class LATVOX_EXPORT DistanceGrid {
 public:
  //   width   world units
  //   whole   no region, bounds or shard leaves out a part of the mesh
  // Precondition: CheckGridTransform(transform) is OK.
  DistanceGrid(const GridTransform& transform, double width, bool is_signed, bool whole);
  DistanceGrid(DistanceGrid&&) noexcept;             // the other one may then only be destroyed or assigned to
  DistanceGrid& operator=(DistanceGrid&&) noexcept;  // replaces this one
  ~DistanceGrid();                                   // frees the grid

  // Adds the batch's voxels. Precondition: its voxels carry distances. Errors: RESOURCE_EXHAUSTED (memory).
  absl::Status Add(const BrickBatch& batch);

  // Writes the request into the grid's metadata: latvox_request, a JSON object with the fields of a line of `latvox
  // batch`, and latvox_region and latvox_bounds if it has them. With the note about the mesh, such a line and the same
  // mesh repeat the whole.
  void SetRequest(const VoxelizeRequest& request, const MeshNote& note = {});

  // Writes the certificate into the grid's metadata.
  void SetCertificate(const Certificate& certificate);

  // Writes the warnings into the grid's metadata: latvox_warnings, a JSON array of objects with code, message and
  // element. Without warnings, writes nothing.
  void SetWarnings(const std::vector<Warning>& warnings);

  // Writes the metadata latvox_... of a file that was read, with their types, over those of the functions above.
  // Ignores others.
  void SetMetadata(const std::vector<std::pair<std::string, std::string>>& metadata);

  // Writes a .vdb file to `path`, replacing an existing file; not atomic. Errors: UNKNOWN, with the path and OpenVDB's
  // message; CANCELLED.
  absl::Status Write(const std::string& path, const Cancellation& cancellation = {});

  // Writes a .nvdb file, with the metadata as text; see VoxelGrid::WriteNano.
  absl::Status WriteNano(const std::string& path, const Cancellation& cancellation = {});

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_GRID_DISTANCE_GRID_H_
