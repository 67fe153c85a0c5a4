// Bounds of positions.
#ifndef LATVOX_CLIENT_TOOL_INSPECT_EXTENT_H_
#define LATVOX_CLIENT_TOOL_INSPECT_EXTENT_H_

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "client/json/json.h"

namespace latvox::client {

// The closed box of the positions that were added.
template <class Number, size_t kCount = 3>
class Extent {
 public:
  void Add(const std::array<Number, kCount>& position) {
    if (!low_) low_ = high_ = position;
    for (size_t m = 0; m < kCount; ++m) {
      (*low_)[m] = std::min((*low_)[m], position[m]);
      high_[m] = std::max(high_[m], position[m]);
    }
  }

  // Returns {"min", "max"}, or null without a position.
  //   beyond   added to the maximum: 1 for half-open boxes of lattice points
  Json ToJson(int64_t beyond = 0) const {
    if (!low_) return Json();
    Json high = Json::array();
    for (const Number x : high_) {
      beyond == 0 ? high.push_back(x) : high.push_back(static_cast<int64_t>(x) + beyond);
    }
    return {{"min", *low_}, {"max", high}};
  }

 private:
  std::optional<std::array<Number, kCount>> low_;
  std::array<Number, kCount> high_{};
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_INSPECT_EXTENT_H_
