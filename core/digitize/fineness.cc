#include "core/digitize/fineness.h"

#include <algorithm>
#include <array>

#include "core/digitize/line_forms.h"

namespace latvox {

Fineness FinenessOf(const SnappedMesh& mesh, const std::vector<ScanFrame>& frames) {
  constexpr size_t kSample = 256, kManyTriangles = 16384;
  const size_t count = mesh.triangles.size();
  if (count < kManyTriangles) return {};
  const LineForms all(frames);
  size_t touching = 0, tiny = 0;
  for (size_t n = 0; n < kSample; ++n) {
    const auto& [i, j, k] = mesh.triangles[n * count / kSample];
    std::array<int32_t, kMaxForms> integers;  // between a form's values at the corners
    for (size_t f = 0; f < all.forms.size(); ++f) {
      const auto floor = [&](uint32_t vertex) { return Dot(all.forms[f], mesh.vertices_lat[vertex]) >> kSubvoxelBits; };
      const auto [first, last] = std::minmax({floor(i), floor(j), floor(k)});
      integers[f] = last - first;
    }
    tiny += std::all_of(integers.begin(), integers.begin() + all.forms.size(),
                        [](int32_t between) { return between <= 1; });
    touching += std::any_of(all.of_frame.begin(), all.of_frame.end(), [&](const LineForms::OfFrame& frame) {
      return integers[frame.form[0]] > 0 && integers[frame.form[1]] > 0;
    });
  }
  return {.few_touch = touching<kSample / 4 * 3, .most_tiny = tiny> kSample / 2};
}

}  // namespace latvox
