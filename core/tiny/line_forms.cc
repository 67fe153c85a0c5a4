#include "core/tiny/line_forms.h"

#include <algorithm>

namespace latvox {

LineForms::LineForms(const std::vector<ScanFrame>& frames) : of_frame(frames.size()) {
  const auto add = [&](size_t frame, size_t row) {
    const Vec3i& r = frames[frame].frame.r[row];
    const int32_t sign = FirstNonzeroIsPositive(r) ? 1 : -1;
    const auto at = std::find(forms.begin(), forms.end(), r * sign);
    of_frame[frame].form[row] = static_cast<size_t>(at - forms.begin());
    of_frame[frame].sign[row] = sign;
    if (at == forms.end()) forms.push_back(r * sign);
  };
  for (size_t n = 0; n < frames.size(); ++n) {
    add(n, 0);
    add(n, 1);
  }
  between = forms.size();
  for (size_t n = 0; n < frames.size(); ++n) add(n, 2);
}

}  // namespace latvox
