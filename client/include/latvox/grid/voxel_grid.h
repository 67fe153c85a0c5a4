// Voxel sets as OpenVDB grids. No OpenVDB header is needed to use this; latvox/grid/openvdb_grid.h gives
// the grid itself to programs that go on with OpenVDB.
//
//   index space     lattice coordinates ijk, on every lattice
//   world space     the grid's affine transform: origin + i*a + j*b + k*c
//   active voxels   the voxel set; values true there, and false (the background) elsewhere
//   metadata        latvox_lattice, latvox_separability, latvox_minimal, latvox_whole_minimal, latvox_cover,
//                   latvox_closed, latvox_digest, latvox_voxel_size, latvox_basis (9 numbers), latvox_origin,
//                   latvox_version, ...; of a solid latvox_fill ("solid"), latvox_interior_rule, latvox_surface,
//                   latvox_unbalanced_lines
#ifndef LATVOX_LATVOX_GRID_VOXEL_GRID_H_
#define LATVOX_LATVOX_GRID_VOXEL_GRID_H_

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "latvox/export.h"
#include "latvox/types.h"

namespace latvox::client {

// Whether OpenVDB takes the transform: all its maps that other programs know refuse a voxel of less than 3e-15 volume.
// Errors: INVALID_ARGUMENT with ErrorDetails, naming voxel_size, its value and the limit.
LATVOX_EXPORT absl::Status CheckGridTransform(const GridTransform& transform);

// A grid being filled: a BoolGrid, the one type for sets that every OpenVDB program reads, python3-openvdb included,
// named "voxels", one leaf for each brick. Not thread-safe. Memory: about 150 bytes for each brick.
class LATVOX_EXPORT VoxelGrid {
 public:
  // Precondition: CheckGridTransform(transform) is OK.
  explicit VoxelGrid(const GridTransform& transform);
  VoxelGrid(VoxelGrid&&) noexcept;             // the other one may then be destroyed or assigned to, no more
  VoxelGrid& operator=(VoxelGrid&&) noexcept;  // as if the one before were destroyed
  ~VoxelGrid();                                // frees the grid, but for pointers to it: see openvdb_grid.h

  // Adds the batch's voxels. Errors: RESOURCE_EXHAUSTED (memory).
  absl::Status Add(const BrickBatch& batch);

  // Writes into the grid's metadata what was asked for: latvox_request, a JSON object with the fields of a line of
  // `latvox batch`, and latvox_region and latvox_bounds of a request for these. With what is noted of the mesh, such a
  // line and the same mesh repeat the whole.
  void SetRequest(const VoxelizeRequest& request, const MeshNote& note = {});

  // Writes the certificate into the grid's metadata.
  void SetCertificate(const Certificate& certificate);

  // The voxels added. Takes a look at each leaf.
  uint64_t CountActiveVoxels() const;

  // Writes a .vdb file to `path`, over what is there; not atomic. Errors: UNKNOWN, with the path and
  // OpenVDB's words.
  absl::Status Write(const std::string& path) const;

  // The same as a .nvdb file (NanoVDB): name, voxels and transform; the metadata as lines of text, "NAME = VALUE", in
  // the blind data "latvox". Errors: as Write.
  absl::Status WriteNano(const std::string& path) const;

  struct Content;                                       // in latvox/grid/openvdb_grid.h
  const Content& content() const { return *content_; }  // for programs that go on with OpenVDB

 private:
  std::unique_ptr<Content> content_;
};

// What a .vdb file holds, of the grid "voxels", or else of its first.
struct GridFileInfo {
  std::string name;                                           // of the grid
  std::string value_type;                                     // OpenVDB's: "bool", "float", ...
  GridTransform transform;                                    // where lattice points are
  uint64_t active_voxels = 0;                                 // of the grid
  std::optional<IndexBox> active_box;                         // absent if there is no active voxel
  std::vector<std::pair<std::string, std::string>> metadata;  // in the order of names
};

// Reads the facts, and every voxel to count them. Errors: NOT_FOUND; INVALID_ARGUMENT (not a readable .vdb file, no
// grid, a transform that is not affine), with the path.
LATVOX_EXPORT absl::StatusOr<GridFileInfo> ReadGridFileInfo(const std::string& path);

// A .vdb file's voxels: the grid "voxels", or else the first grid. Bricks are in lexicographic order of brick_ijk.
struct GridFile {
  GridFileInfo info;          // facts and metadata
  std::vector<Brick> bricks;  // none is empty
};

// Memory: 230 bytes for each brick while it reads, 80 then. Active tiles, which latvox does not write, are read as
// bricks. Errors: as above; a grid that is not boolean, or has tiles of more than 2^31 voxels; a transform that is not
// of finite numbers.
LATVOX_EXPORT absl::StatusOr<GridFile> ReadGridFile(const std::string& path);

// The metadata latvox_digest of a .vdb file's first grid, empty if there is none; no voxel is read. Errors: as above.
LATVOX_EXPORT absl::StatusOr<std::string> ReadGridFileDigest(const std::string& path);

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_GRID_VOXEL_GRID_H_
