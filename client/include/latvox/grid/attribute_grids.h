// Voxels with attributes as OpenVDB grids. Programs need no OpenVDB header for this.
//
//   "voxels"            the set, as in latvox/grid/voxel_grid.h
//   "part", "material"  a grid of 32-bit integers each; among OpenVDB's own programs, vdb_ax reads their values
//   "color"             a grid of three floats from 0 to 1: red, green, blue
//
// All have the same transform, metadata (with latvox_attributes, their names, and latvox_attributes_digest) and active
// voxels. Elsewhere numbers are -1, and colors 0.
#ifndef LATVOX_LATVOX_GRID_ATTRIBUTE_GRIDS_H_
#define LATVOX_LATVOX_GRID_ATTRIBUTE_GRIDS_H_

#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "latvox/export.h"
#include "latvox/grid/carried_names.h"
#include "latvox/types.h"

namespace latvox::client {

// Grids that are being filled. Not thread-safe. Memory for each brick: about 2.5 KB an attribute, 7 KB a color.
class LATVOX_EXPORT AttributeGrids {
 public:
  // Precondition: CheckGridTransform(transform) is OK.
  AttributeGrids(const GridTransform& transform, const std::vector<Attribute>& attributes);
  AttributeGrids(AttributeGrids&&) noexcept;             // the other one may then only be destroyed or assigned to
  AttributeGrids& operator=(AttributeGrids&&) noexcept;  // replaces this one
  ~AttributeGrids();                                     // frees the grids

  // Adds the batch's voxels. Precondition: they carry these attributes. Errors: RESOURCE_EXHAUSTED (memory).
  absl::Status Add(const BrickBatch& batch);

  // Writes the request into the grids' metadata: latvox_request, a JSON object with the fields of a line of `latvox
  // batch`, and latvox_region and latvox_bounds if it has them. With the note about the mesh, such a line and the same
  // mesh repeat the whole.
  void SetRequest(const VoxelizeRequest& request, const MeshNote& note = {});

  // Writes the names of parts and materials into the grids' metadata, as far as the grids have these attributes: see
  // latvox/grid/carried_names.h. At most 10,000 names of each are kept.
  void SetNames(const CarriedNames& names);

  // Writes the certificate into the grids' metadata.
  void SetCertificate(const Certificate& certificate);

  // Writes the warnings into the grids' metadata: latvox_warnings, a JSON array of objects with code, message and
  // element. Without warnings, writes nothing.
  void SetWarnings(const std::vector<Warning>& warnings);

  // Writes a .vdb file of all grids to `path`, replacing an existing file; not atomic. Errors: UNKNOWN, with the path
  // and OpenVDB's message.
  absl::Status Write(const std::string& path);

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_GRID_ATTRIBUTE_GRIDS_H_
