// What differs between what voxels have besides their places.
#ifndef LATVOX_CLIENT_TOOL_CLI_VALUE_DIFFERENCE_H_
#define LATVOX_CLIENT_TOOL_CLI_VALUE_DIFFERENCE_H_

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "latvox/grid/grid_content.h"
#include "latvox/types.h"

namespace latvox::client {

struct DistanceDifference {
  uint64_t differ = 0;      // how many
  double greatest = 0;      // difference, world units
  std::optional<Vec3i> at;  // the first voxel of that one, in the order of bricks
};

// Of the voxels that both have.
struct ValueDifference {
  std::optional<DistanceDifference> distances;             // of two bands
  std::vector<std::pair<Attribute, uint64_t>> attributes;  // those that both have; how many numbers differ

  bool equal() const;
};

// Precondition: both were read with their values.
ValueDifference CompareValues(const GridContent& a, const GridContent& b);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_CLI_VALUE_DIFFERENCE_H_
