// Differences between the values of voxels.
#ifndef LATVOX_CLIENT_TOOL_CLI_VALUE_DIFFERENCE_H_
#define LATVOX_CLIENT_TOOL_CLI_VALUE_DIFFERENCE_H_

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "latvox/grid/grid_content.h"
#include "latvox/types.h"

namespace latvox::client {

// A field that voxels of both files carry.
struct CommonField {
  const FieldValues *a, *b;

  // Returns whether the m-th voxel of a and the n-th of b carry different values.
  bool Differs(size_t m, size_t n) const;
};

// Fields of different labels or neighbors are not common.
std::vector<CommonField> CommonFields(const GridContent& a, const GridContent& b);

struct DistanceDifference {
  uint64_t differ = 0;      // number of voxels
  double greatest = 0;      // greatest difference, world units
  std::optional<Vec3i> at;  // the first voxel with it, in the order of bricks
};

struct LinkDifference {
  uint64_t crossed_in_one = 0;  // number of links that are crossed in one file alone
  double greatest = 0;          // greatest difference of shares where both are crossed
};

// Compares the voxels that both files have.
struct ValueDifference {
  std::optional<DistanceDifference> distances;  // if both carry them
  std::optional<LinkDifference> links;          // if both carry Field::kLinks, which is among the others, too
  // Other fields of both files, with the number of voxels that differ.
  std::vector<std::pair<Field, uint64_t>> others;

  bool equal() const;
};

// Precondition: both were read with their values.
ValueDifference CompareValues(const GridContent& a, const GridContent& b);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_VALUE_DIFFERENCE_H_
