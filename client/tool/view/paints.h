// Choices of colors for the voxels of a page.
#ifndef LATVOX_CLIENT_TOOL_VIEW_PAINTS_H_
#define LATVOX_CLIENT_TOOL_VIEW_PAINTS_H_

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "latvox/grid/grid_content.h"

namespace latvox::client {

// Values are uint32 or float32, little-endian. Fields of links have the numbers of OneOfLinks.
struct Paint {
  std::string name;                                         // of the field; for one label: "fraction_7 (lid)"
  std::string bytes;                                        // red, green, blue of each voxel, in order
  std::string values;                                       // of each voxel, 4 bytes a component; or none
  size_t components = 1;                                    // of a value
  bool has_floats = false;                                  // the values are floats, otherwise integers
  bool is_mix = false;                                      // the colors of several labels: neither colors nor values
  bool is_ramp = false;                                     // whether the legend is a continuous ramp
  std::vector<std::pair<std::string, std::string>> legend;  // "#rrggbb" and its meaning, or ""
};

// Voxels times paints.
inline constexpr uint64_t kMaxPageColors = 20'000'000;

// Returns one paint for each field of the voxels. The default comes first. Fractions of labels have one for all labels
// together, then one for each. Errors: RESOURCE_EXHAUSTED: more than kMaxPageColors.
absl::StatusOr<std::vector<Paint>> PaintsOf(const GridContent& content);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_VIEW_PAINTS_H_
