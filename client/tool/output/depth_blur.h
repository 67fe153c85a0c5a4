// The surface beneath the facets of small cells.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_DEPTH_BLUR_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_DEPTH_BLUR_H_

#include <limits>
#include <vector>

namespace latvox::client {

// Of a sample that shows nothing.
inline constexpr float kNoDepth = -std::numeric_limits<float>::infinity();

// Depths of `wide` rows of `wide` samples, in samples, averaged over `radius` samples on every side, twice, but not
// across the edges of the shape: where depths differ by more than three times the radius.
std::vector<float> SmoothDepth(const std::vector<float>& depth, int wide, int radius);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_DEPTH_BLUR_H_
