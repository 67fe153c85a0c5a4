// What differs between two voxel sets.
#ifndef LATVOX_CLIENT_TOOL_CLI_VOXEL_DIFFERENCE_H_
#define LATVOX_CLIENT_TOOL_CLI_VOXEL_DIFFERENCE_H_

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "latvox/grid/voxel_grid.h"
#include "latvox/types.h"

namespace latvox::client {

// By lattice coordinates.
struct VoxelDifference {
  static constexpr size_t kFirst = 10;

  uint64_t only_a = 0, only_b = 0, both = 0;
  std::optional<IndexBox> box;                // of all voxels that only one has
  std::vector<std::pair<Vec3i, bool>> first;  // the first of them in the order of bricks; true: A has it

  bool equal() const { return only_a == 0 && only_b == 0; }
  double Jaccard() const;  // both, of all that there are; 1 if there is none
};

// Both in lexicographic order of brick_ijk, each brick once.
VoxelDifference CompareVoxels(std::span<const Brick> a, std::span<const Brick> b);

// Something that a file says in words, and the other says otherwise, or not at all: an empty word.
struct FieldDifference {
  std::string name, a, b;
};

// Type, transform and metadata, but for what says the same again (latvox_basis beside the transform) and OpenVDB's own
// statistics (file_...).
std::vector<FieldDifference> CompareFields(const GridFileInfo& a, const GridFileInfo& b);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_VOXEL_DIFFERENCE_H_
