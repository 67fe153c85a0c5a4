// Shares of a range.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_SHARE_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_SHARE_H_

#include <algorithm>

namespace latvox::client {

// Returns where x lies between `none` (0) and `all` (1).
inline float ShareOf(float x, float none, float all) { return std::clamp((x - none) / (all - none), 0.0F, 1.0F); }

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_SHARE_H_
