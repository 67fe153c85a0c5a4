// Voxels with fields as OpenVDB grids. Programs need no OpenVDB header for this.
//
//   "voxels"                        the set, as in latvox/grid/voxel_grid.h
//   "part", "material", "triangle"  a grid of 32-bit integers each; among OpenVDB's own programs, vdb_ax reads them
//   "color"                         a grid of three floats from 0 to 1: red, green, blue
//   "distance"                      a grid of floats, world units
//   "point"                         a grid of three floats: the two weights, and 0
//   "normal"                        a grid of three floats: x, y, z
//   "fraction"                      a grid of 32-bit integers
//   "fraction_7", ...               for label_fractions, a grid of 32-bit integers for each label
//   "link_-1_0_1", ...              for links, a grid of floats for each neighbor: the shares of links that are crossed
//   "link_triangle_-1_0_1", ...     for link_triangles, a grid of 32-bit integers for each neighbor
//   "link_crossings_-1_0_1", ...    for link_crossings, likewise
//
// All have the same transform and metadata: with latvox_fields, their names, and latvox_part_digest and so on. A grid
// of links has active voxels where the mesh crosses the link to its neighbor. All other grids have the voxels of the
// set. Elsewhere integers are -1 (of link_crossings 0), and floats 0. For a band with distances alone, see
// latvox/grid/distance_grid.h.
#ifndef LATVOX_LATVOX_GRID_FIELD_GRIDS_H_
#define LATVOX_LATVOX_GRID_FIELD_GRIDS_H_

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "latvox/cancellation.h"
#include "latvox/export.h"
#include "latvox/grid/carried_names.h"
#include "latvox/types.h"

namespace latvox::client {

// Grids that are being filled. Not thread-safe. Memory for each brick: about 2.5 KB for a field with one number or each
// label, 7 KB for others. Fields of links have 4 bytes for each voxel and neighbor, three times as much while they
// grow, and while they are written, one more grid.
class LATVOX_EXPORT FieldGrids {
 public:
  // Precondition: CheckGridTransform(transform) is OK.
  //   fraction_labels   see Accepted
  //   neighbors         see Accepted; not empty if there is a field of links
  FieldGrids(const GridTransform& transform, const std::vector<Field>& fields,
             const std::vector<uint32_t>& fraction_labels = {}, const std::vector<Vec3i>& neighbors = {});
  FieldGrids(FieldGrids&&) noexcept;             // the other one may then only be destroyed or assigned to
  FieldGrids& operator=(FieldGrids&&) noexcept;  // replaces this one
  ~FieldGrids();                                 // frees the grids

  // Adds the batch's voxels. Precondition: they carry these fields. Errors: RESOURCE_EXHAUSTED (memory).
  absl::Status Add(const BrickBatch& batch);

  // Writes the request into the grids' metadata: latvox_request, a JSON object with the fields of a line of `latvox
  // batch`, and latvox_region and latvox_bounds if it has them. With the note about the mesh, such a line and the same
  // mesh repeat the whole.
  void SetRequest(const VoxelizeRequest& request, const MeshNote& note = {});

  // Writes the names of parts and materials into the grids' metadata, as far as the grids have these fields: see
  // latvox/grid/carried_names.h. At most 10,000 names of each are kept.
  void SetNames(const CarriedNames& names);

  // Writes the certificate into the grids' metadata.
  void SetCertificate(const Certificate& certificate);

  // Writes the warnings into the grids' metadata: latvox_warnings, a JSON array of objects with code, message and
  // element. Without warnings, writes nothing.
  void SetWarnings(const std::vector<Warning>& warnings);

  // Writes the metadata latvox_... of a file that was read, with their types, over those of the functions above.
  // Ignores others.
  void SetMetadata(const std::vector<std::pair<std::string, std::string>>& metadata);

  // Writes a .vdb file of all grids to `path`, replacing an existing file; not atomic. Errors: UNKNOWN, with the path
  // and OpenVDB's message; CANCELLED.
  absl::Status Write(const std::string& path, const Cancellation& cancellation = {});

  // Writes a .nvdb file of all grids, with the metadata as text; see VoxelGrid::WriteNano.
  absl::Status WriteNano(const std::string& path, const Cancellation& cancellation = {}) const;

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_GRID_FIELD_GRIDS_H_
