// What the voxels of a page may be colored by.
#ifndef LATVOX_CLIENT_TOOL_VIEW_PAINTS_H_
#define LATVOX_CLIENT_TOOL_VIEW_PAINTS_H_

#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "latvox/grid/grid_content.h"

namespace latvox::client {

struct Paint {
  std::string name;                                         // "part", "material", "color" or "distance"
  std::string bytes;                                        // red, green, blue of each voxel, in their order
  bool is_ramp = false;                                     // whether the legend goes from one color to the next
  std::vector<std::pair<std::string, std::string>> legend;  // "#rrggbb" and what it stands for, or nothing
};

// One for each thing that the voxels have besides their places; first what they are colored by unless somebody says.
absl::StatusOr<std::vector<Paint>> PaintsOf(const GridContent& content);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_VIEW_PAINTS_H_
