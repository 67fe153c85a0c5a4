// Neighbors of the cells of a brick.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_MASK_STEP_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_MASK_STEP_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "latvox/types.h"

namespace latvox::client {

// One step from each cell of a brick: a few shifts of words in place of 512 look-ups. Each coordinate of the step is at
// least -7 and at most 7, so the steps along y and along z end in one of two bricks each.
class MaskStep {
 public:
  using Mask = decltype(Brick::mask);

  explicit MaskStep(const Vec3i& step) : x_(step[0]) {
    const auto ahead = [](int32_t along) { return along < 0 ? -1 : 1; };
    for (size_t n = 0; n < parts_.size(); ++n) {
      Part& part = parts_[n];
      part.y = n < 2 ? 0 : ahead(step[1]);
      part.z = n % 2 == 0 ? 0 : ahead(step[2]);
      part.by = 8 * (step[1] - 8 * part.y) + step[2] - 8 * part.z;
      for (int32_t cell = 0; cell < 64; ++cell) {
        const bool ends_there = (cell / 8 + step[1]) >> 3 == part.y && (cell % 8 + step[2]) >> 3 == part.z;
        if (ends_there) part.cells |= uint64_t{1} << cell;
      }
    }
  }

  // Returns the cells whose step ends at a cell. mask_at(brick) returns the mask of a brick, relative to theirs.
  template <class MaskAt>
  Mask From(const MaskAt& mask_at) const {
    Mask out{};
    for (int32_t x = 0; x < 8; ++x) {
      const int32_t to = x + x_;
      for (const Part& part : parts_) {
        if (part.cells == 0) continue;
        const uint64_t word = mask_at(Vec3i{to >> 3, part.y, part.z})[static_cast<size_t>(to & 7)];
        out[static_cast<size_t>(x)] |= (part.by < 0 ? word << -part.by : word >> part.by) & part.cells;
      }
    }
    return out;
  }

 private:
  struct Part {
    int32_t y, z;        // the brick where the step ends
    int32_t by;          // difference of the bits of both cells in their words
    uint64_t cells = 0;  // whose step ends there
  };

  int32_t x_;
  std::array<Part, 4> parts_{};
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_MASK_STEP_H_
