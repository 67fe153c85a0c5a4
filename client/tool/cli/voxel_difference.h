// Differences between two voxel sets.
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

// Compares by lattice coordinates.
struct VoxelDifference {
  static constexpr size_t kFirst = 10;

  uint64_t only_a = 0, only_b = 0, both = 0;
  std::optional<IndexBox> box;                // bounds the voxels that only one set has
  std::vector<std::pair<Vec3i, bool>> first;  // the first such voxels in the order of bricks; true: A has it

  bool equal() const { return only_a == 0 && only_b == 0; }
  double Jaccard() const;  // |A and B| / |A or B|; 1 if both are empty
};

// Precondition: both are in lexicographic order of brick_ijk, each brick once.
VoxelDifference CompareVoxels(std::span<const Brick> a, std::span<const Brick> b);

// A field whose text differs between the files. The text is empty where a file lacks the field.
struct FieldDifference {
  std::string name, a, b;
};

// Compares type, transform and metadata. Skips metadata that repeat the transform (latvox_basis) and OpenVDB's own
// statistics (file_...).
std::vector<FieldDifference> CompareFields(const GridFileInfo& a, const GridFileInfo& b);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_VOXEL_DIFFERENCE_H_
