// The linear forms that number lattice lines, for all directions together.
#ifndef LATVOX_CORE_TINY_LINE_FORMS_H_
#define LATVOX_CORE_TINY_LINE_FORMS_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/vec.h"
#include "core/digitize/principal_scan.h"

namespace latvox {

// Rows of frames (core/lattice/frame.h), each with a first nonzero entry above 0. So the shift of
// core/digitize/crossing.h moves the form's value up, and floors of values need not consider it. Many frames share
// them.
struct LineForms {
  // Row n of a frame is sign[n] times the form of that number.
  struct OfFrame {
    std::array<size_t, 3> form;
    std::array<int32_t, 3> sign;
  };
  std::vector<Vec3i> forms;
  size_t between = 0;  // so many forms at the front occur as rows 0 or 1: lattice lines lie between their values
  std::vector<OfFrame> of_frame;

  explicit LineForms(const std::vector<ScanFrame>& frames);
};

inline constexpr size_t kMaxForms = 3 * kMaxPairs;

}  // namespace latvox

#endif  // LATVOX_CORE_TINY_LINE_FORMS_H_
