// Lattice vectors as text.
#ifndef LATVOX_CLIENT_GRID_STEPS_TEXT_H_
#define LATVOX_CLIENT_GRID_STEPS_TEXT_H_

#include <string>
#include <vector>

#include "absl/strings/str_join.h"
#include "latvox/types.h"

namespace latvox::client {

// Returns "-1,0,1 1,0,0".
inline std::string StepsText(const std::vector<Vec3i>& steps) {
  return absl::StrJoin(steps, " ", [](std::string* out, const Vec3i& step) { *out += absl::StrJoin(step, ","); });
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_STEPS_TEXT_H_
