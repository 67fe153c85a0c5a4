// Voxel sets as OpenVDB grids. No OpenVDB header is needed to use this; client/grid/openvdb_grid.h gives the grid
// itself to programs that go on with OpenVDB.
//
//   index space     lattice coordinates ijk, on every lattice
//   world space     the grid's affine transform: origin + i*a + j*b + k*c
//   active voxels   the voxel set; values true there, and false (the background) elsewhere
//   metadata        latvox_lattice, latvox_separability, latvox_minimal, latvox_cover, latvox_closed, latvox_digest,
//                   latvox_voxel_size, latvox_basis (9 numbers), latvox_origin, latvox_version, ...
#ifndef LATVOX_CLIENT_GRID_VOXEL_GRID_H_
#define LATVOX_CLIENT_GRID_VOXEL_GRID_H_

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/types.h"

namespace latvox::client {

// Whether OpenVDB takes the transform: all its maps that other programs know refuse a voxel of less than 3e-15 volume.
// Errors: INVALID_ARGUMENT with ErrorDetails, naming voxel_size, its value and the limit.
absl::Status CheckGridTransform(const GridTransform& transform);

// A grid being filled: a BoolGrid, the one type for sets that every OpenVDB program reads, python3-openvdb included,
// named "voxels", one leaf for each brick. Not thread-safe. Memory: about 150 bytes for each brick.
class VoxelGrid {
 public:
  // Precondition: CheckGridTransform(transform) is OK.
  explicit VoxelGrid(const GridTransform& transform);
  VoxelGrid(VoxelGrid&&) noexcept;
  VoxelGrid& operator=(VoxelGrid&&) noexcept;
  ~VoxelGrid();

  // Adds the batch's voxels. Errors: RESOURCE_EXHAUSTED (memory).
  absl::Status Add(const BrickBatch& batch);

  // Writes the certificate into the grid's metadata.
  void SetCertificate(const Certificate& certificate);

  uint64_t CountActiveVoxels() const;

  // Writes a .vdb file to `path`, over what is there; not atomic. Errors: UNKNOWN, with the path and
  // OpenVDB's words.
  absl::Status Write(const std::string& path) const;

  struct Content;
  const Content& content() const { return *content_; }  // see client/grid/openvdb_grid.h

 private:
  std::unique_ptr<Content> content_;
};

// What a .vdb file holds, of its first grid.
struct GridFileInfo {
  std::string name, value_type;  // value_type is OpenVDB's: "bool", "float", ...
  GridTransform transform;
  uint64_t active_voxels = 0;
  std::optional<IndexBox> active_box;                         // absent if there is no active voxel
  std::vector<std::pair<std::string, std::string>> metadata;  // in the order of names
};

// Errors: NOT_FOUND; INVALID_ARGUMENT (not a readable .vdb file, no grid, a transform that is not affine), with the
// path.
absl::StatusOr<GridFileInfo> ReadGridFileInfo(const std::string& path);

// The metadata latvox_digest of a .vdb file's first grid, empty if there is none; no voxel is read. Errors: as above.
absl::StatusOr<std::string> ReadGridFileDigest(const std::string& path);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_VOXEL_GRID_H_
