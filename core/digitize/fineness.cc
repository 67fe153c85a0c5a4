#include "core/digitize/fineness.h"

#include <algorithm>
#include <array>

#include "core/digitize/line_forms.h"
#include "core/digitize/sift.h"

namespace latvox {

Fineness FinenessOf(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames) {
  constexpr size_t kSample = 256, kManyTriangles = 16384;
  // Tiny triangles take their time for each line between their corners, the others mostly once.
  constexpr size_t kFewLines = 8;
  const size_t count = mesh.triangles.size();
  if (count < kManyTriangles) return {};
  const LineForms all(frames);
  size_t touching = 0, tiny = 0, lines_of_tiny = 0;
  for (size_t n = 0; n < kSample; ++n) {
    const auto& [i, j, k] = mesh.triangles[n * count / kSample];
    std::array<int32_t, kMaxForms> integers{};  // between a form's values at the corners
    for (size_t f = 0; f < all.forms.size(); ++f) {
      const auto floor = [&](uint32_t vertex) { return Dot(all.forms[f], mesh.vertices_lat[vertex]) >> kSubvoxelBits; };
      const auto [first, last] = std::minmax({floor(i), floor(j), floor(k)});
      integers[f] = last - first;
    }
    const bool is_tiny = *std::max_element(integers.begin(), integers.end()) <= kMostIntegers;
    bool touches = false;
    for (const LineForms::OfFrame& frame : all.of_frame) {
      const int32_t a = integers[frame.form[0]], b = integers[frame.form[1]];
      touches |= a > 0 && b > 0;
      if (is_tiny) lines_of_tiny += static_cast<size_t>(a * b);
    }
    tiny += is_tiny ? 1 : 0;
    touching += touches ? 1 : 0;
  }
  const bool few_touch = touching < kSample / 4 * 3;
  const bool most_tiny = tiny >= kSample / 8 * 5 && lines_of_tiny <= kFewLines * tiny;
  return {few_touch, most_tiny};
}

}  // namespace latvox
