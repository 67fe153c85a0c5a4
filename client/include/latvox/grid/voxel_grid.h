// Voxel sets as OpenVDB grids. Programs need no OpenVDB header for this. latvox/grid/openvdb_grid.h has the grid
// itself, for programs that go on with OpenVDB.
//
//   index space     lattice coordinates ijk, on every lattice
//   world space     the grid's affine transform: origin + i*a + j*b + k*c
//   active voxels   the voxel set; the value is true there, and false (the background) elsewhere
//   metadata        latvox_lattice, latvox_separability, latvox_minimal, latvox_whole_minimal, latvox_set,
//                   latvox_closed, latvox_digest, latvox_voxel_size, latvox_basis (9 numbers), latvox_origin,
//                   latvox_version, ...; of a solid latvox_unbalanced_lines; latvox_interior_rule, where the set or a
//                   field depends on the inside
#ifndef LATVOX_LATVOX_GRID_VOXEL_GRID_H_
#define LATVOX_LATVOX_GRID_VOXEL_GRID_H_

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "latvox/cancellation.h"
#include "latvox/export.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns whether OpenVDB accepts the transform: all its maps that other programs know refuse a voxel with a volume of
// less than 3e-15. Errors: INVALID_ARGUMENT with ErrorDetails, naming voxel_size, its value and the limit.
LATVOX_EXPORT absl::Status CheckGridTransform(const GridTransform& transform);

// A grid that is being filled: a BoolGrid named "voxels", with a leaf for each brick, and tiles where all voxels
// are in the set. Every OpenVDB program reads this type, python3-openvdb included. Not thread-safe. Memory: about 150
// bytes for each brick that lacks voxels.
class LATVOX_EXPORT VoxelGrid {
 public:
  // Precondition: CheckGridTransform(transform) is OK.
  explicit VoxelGrid(const GridTransform& transform);
  VoxelGrid(VoxelGrid&&) noexcept;             // the other one may then only be destroyed or assigned to
  VoxelGrid& operator=(VoxelGrid&&) noexcept;  // replaces this one
  ~VoxelGrid();                                // frees the grid, except where pointers share it: see openvdb_grid.h

  // Adds the batch's voxels. Errors: RESOURCE_EXHAUSTED (memory).
  absl::Status Add(const BrickBatch& batch);

  // Writes the request into the grid's metadata: latvox_request, a JSON object with the fields of a line of `latvox
  // batch`, and latvox_region and latvox_bounds if it has them. With the note about the mesh, such a line and the same
  // mesh repeat the whole. With its facts, latvox_mesh_triangles and latvox_mesh_box tell what mesh it was.
  void SetRequest(const VoxelizeRequest& request, const MeshNote& note = {});

  // Writes the certificate into the grid's metadata.
  void SetCertificate(const Certificate& certificate);

  // Writes the warnings into the grid's metadata: latvox_warnings, a JSON array of objects with code, message and
  // element. Without warnings, writes nothing.
  void SetWarnings(const std::vector<Warning>& warnings);

  // Writes the metadata latvox_... of a file that was read, with their types, over those of the functions above.
  // Ignores others.
  void SetMetadata(const std::vector<std::pair<std::string, std::string>>& metadata);

  // Returns the number of voxels added. Visits each leaf.
  uint64_t CountActiveVoxels() const;

  // Writes a .vdb file to `path`, replacing an existing file; not atomic. Prunes the grid's tree before. Errors:
  // UNKNOWN, with the path and OpenVDB's message; CANCELLED.
  absl::Status Write(const std::string& path, const Cancellation& cancellation = {}) const;

  // Writes the same as a .nvdb file (NanoVDB): name, voxels and transform. The metadata are lines of text, "NAME =
  // VALUE", in the blind data "latvox". Errors: as Write.
  absl::Status WriteNano(const std::string& path, const Cancellation& cancellation = {}) const;

  struct Content;                                       // in latvox/grid/openvdb_grid.h
  const Content& content() const { return *content_; }  // for programs that go on with OpenVDB

 private:
  std::unique_ptr<Content> content_;
};

// Functions that read a .vdb file's voxels do so in the calling process, by OpenVDB. It trusts the file: a damaged one
// can crash the process, or take all its memory, before there is an error. `latvox` reads files in a process of their
// own. The functions read .nvdb files as well, with grids of bool, float, int32 or three floats. A grid that is
// compressed (ZIP, BLOSC) may unpack to 512 MiB, or to 32 times its bytes if that is more.

// Facts about a .vdb file: about its grid "voxels", or else its first grid.
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

// Reads the same facts about the first grid of a .nvdb file (NanoVDB), as far as its header tells: counts and box are
// not verified. The metadata are those of VoxelGrid::WriteNano. Reads no voxel. Errors, with the path:
// NOT_FOUND; INVALID_ARGUMENT (not a readable .nvdb file, cut short); RESOURCE_EXHAUSTED (memory);
// FAILED_PRECONDITION: the grid is compressed, and ReadGridFileInfo reads it.
LATVOX_EXPORT absl::StatusOr<GridFileInfo> ReadNanoFileInfo(const std::string& path);

// A .vdb file's voxels: the grid "voxels", or else the first grid. Bricks are in lexicographic order of brick_ijk.
struct GridFile {
  GridFileInfo info;          // facts and metadata
  std::vector<Brick> bricks;  // none is empty
};

// Reads the file's voxels. Memory: 230 bytes for each brick while it reads, 80 for each one of a tile and afterwards.
// Active tiles are read as bricks. Errors: as above; a grid that is not boolean, or has tiles of more than 2^34 voxels;
// a transform with numbers that are not finite.
LATVOX_EXPORT absl::StatusOr<GridFile> ReadGridFile(const std::string& path);

// Returns the metadata latvox_digest of a .vdb file's first grid, or an empty text. Reads no voxel, and is safe with
// damaged files. Errors: NOT_FOUND; INVALID_ARGUMENT, with the path: not a readable .vdb file, of another format
// version than this OpenVDB writes, or no grid.
LATVOX_EXPORT absl::StatusOr<std::string> ReadGridFileDigest(const std::string& path);

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_GRID_VOXEL_GRID_H_
