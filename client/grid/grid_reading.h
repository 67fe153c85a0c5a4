// Opens and describes .vdb files, with grids of any type. Includes OpenVDB's headers. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_GRID_READING_H_
#define LATVOX_CLIENT_GRID_GRID_READING_H_

#include <algorithm>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "client/grid/openvdb_trees.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {

// Returns the result of read(file) for the file, opened without its voxels. Errors: NOT_FOUND; INVALID_ARGUMENT (an
// exception of OpenVDB), with the path; RESOURCE_EXHAUSTED: memory.
template <class Read>
auto WithFile(const std::string& path, const Read& read) -> decltype(read(std::declval<openvdb::io::File&>())) try {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return absl::NotFoundError(absl::StrCat(path, ": no such file"));
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open(/*delayLoad=*/false);
  return read(file);
} catch (const std::bad_alloc&) {
  return absl::ResourceExhaustedError(absl::StrCat(path, ": is larger than the memory at hand"));
} catch (const std::exception& error) {
  return absl::InvalidArgumentError(absl::StrCat(path, ": is not a readable .vdb file (", error.what(), ")"));
}

// Looks at each leaf.
GridFileInfo Describe(const openvdb::GridBase& grid);

// Errors: INVALID_ARGUMENT, with the path: the transform is not affine, or has numbers that are not finite.
absl::Status CheckTransform(const openvdb::GridBase& grid, const std::string& path);

// The most voxels in active tiles, which latvox does not write, but other programs make of full bricks. A few bytes of
// a file could stand for gigabytes of leaves.
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
