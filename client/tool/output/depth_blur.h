// Smooths the facets of small cells into a surface.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_DEPTH_BLUR_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_DEPTH_BLUR_H_

#include <limits>
#include <vector>

namespace latvox::client {

// The depth of a sample without a surface.
inline constexpr float kNoDepth = -std::numeric_limits<float>::infinity();

// Returns depths, averaged twice over `radius` samples on every side. The input has `wide` rows of `wide` samples;
// depths are in samples. Averages do not cross edges of the shape, where depths differ by more than three times the
// radius.
std::vector<float> SmoothDepth(const std::vector<float>& depth, int wide, int radius);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_DEPTH_BLUR_H_
