// Opens and describes .vdb and .nvdb files, with grids of any type. Includes OpenVDB's headers. Internal to
// latvox::grid.
#ifndef LATVOX_CLIENT_GRID_GRID_READING_H_
#define LATVOX_CLIENT_GRID_GRID_READING_H_

#include <algorithm>
#include <cstdint>
#include <exception>
#include <istream>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "client/grid/grid_archive.h"
#include "client/grid/grid_frame.h"
#include "client/grid/nano_archive.h"
#include "client/grid/nano_names.h"
#include "client/grid/open_file.h"
#include "client/grid/openvdb_trees.h"
#include "client/internal/printable.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {

// Returns the result of read(archive) for the file's bytes. Errors: INVALID_ARGUMENT (kNoGridFile, an exception of
// OpenVDB or NanoVDB, or the end of the bytes), with the path; RESOURCE_EXHAUSTED: memory.
template <class Read>
auto WithArchive(std::istream& in, const std::string& path, const Read& read)
    -> decltype(read(std::declval<GridArchive&>())) {
  std::string why;
  const uint64_t magic = ReadMagic(in);
  const bool is_nano = IsNanoMagic(magic);
  if (!is_nano && magic != kVdbMagic) return absl::InvalidArgumentError(path + kNoGridFile);
  try {
    openvdb::initialize();
    const auto archive = is_nano ? OpenNanoArchive(in) : OpenVdbArchive(in);
    return read(*archive);
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrCat(path, ": is larger than the memory at hand"));
  } catch (const std::ios_base::failure&) {
    why = "it is cut short";
  } catch (const std::exception& error) {
    why = Printable(absl::StripPrefix(error.what(), "IoError: "));
  }
  return absl::InvalidArgumentError(
      absl::StrCat(path, ": is not a readable ", is_nano ? ".nvdb" : ".vdb", " file (", why, ")"));
}

// Calls WithArchive for the file.
template <class Read>
auto WithFile(const std::string& path, const Read& read) -> decltype(read(std::declval<GridArchive&>())) {
  auto file = OpenGridFile(path);
  if (!file.ok()) return file.status();
  return WithArchive(*file, path, read);
}

// Reads the voxels of the grid "voxels", or else of the only bool grid. Errors as in ReadGridFile.
absl::StatusOr<GridFile> ReadVoxels(GridArchive& archive, const std::string& path);

// Looks at each leaf.
GridFileInfo Describe(const openvdb::GridBase& grid);

// Returns whether the transform is affine, and all its numbers are finite. Throws exceptions of OpenVDB: it has no
// inverse.
bool IsAffine(const openvdb::math::Transform& transform);

// Errors: INVALID_ARGUMENT, with the path: not IsAffine. Throws as it does.
absl::Status CheckTransform(const openvdb::GridBase& grid, const std::string& path);

// The most voxels in active tiles of grids with values. latvox does not write such tiles, but other programs do. A few
// bytes of a file could stand for gigabytes of leaves.
inline constexpr uint64_t kMaxTileVoxels = uint64_t{1} << 31;

// Returns the leaves with active voxels, in lexicographic order of their corners; active tiles become leaves. Errors:
// INVALID_ARGUMENT, with the path: tiles with more voxels than kMaxTileVoxels.
template <class Tree>
absl::StatusOr<std::vector<const typename Tree::LeafNodeType*>> SortedLeaves(Tree& tree, const std::string& path) {
  if (tree.activeTileCount() > 0) {
    const uint64_t voxels = tree.activeVoxelCount() - tree.activeLeafVoxelCount();
    if (voxels > kMaxTileVoxels) {
      return absl::InvalidArgumentError(
          absl::StrCat(path, ": has active tiles of ", voxels, " voxels, more than ", kMaxTileVoxels));
    }
    tree.voxelizeActiveTiles();
  }
  std::vector<const typename Tree::LeafNodeType*> leaves;
  leaves.reserve(tree.leafCount());
  for (auto leaf = std::as_const(tree).cbeginLeaf(); leaf; ++leaf) {
    if (!leaf->isEmpty()) leaves.push_back(leaf.getLeaf());
  }
  std::sort(leaves.begin(), leaves.end(), [](const auto* a, const auto* b) { return a->origin() < b->origin(); });
  return leaves;
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_GRID_READING_H_
