// The meaning of colors.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_LEGEND_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_LEGEND_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/tool/output/voxel_colors.h"
#include "latvox/grid/grid_content.h"

namespace latvox::client {

struct LegendEntry {
  std::optional<uint32_t> color;  // absent: the text is about what has no entry
  std::string text;
};

// A list of colors, or steps of a continuous ramp, most of them without a text.
struct Legend {
  bool is_ramp = false;
  std::vector<LegendEntry> entries = {};
};

// Returns the legend of the colors that ColorsOf gives the voxels. Parts and materials come in order, colors by their
// number of voxels. A label of fractions has the number of voxels that it would fill.
//   most   entries; another one tells how many are left out
Legend LegendOf(const GridContent& content, ColorBy by, size_t most);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_LEGEND_H_
