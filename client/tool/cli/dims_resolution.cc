#include "client/tool/cli/dims_resolution.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "client/tool/cli/common_options.h"

namespace latvox::client {
namespace {

// Returns by how much a mesh may grow so that its box has the sides of the array: the steps between the outermost
// voxels grow as the resolution does.
double Growth(const IndexBox& box, const BoxShape& shape) {
  double growth = kMaxResolution;
  for (size_t m = 0; m < 3; ++m) {
    const double steps = (*shape.dims)[m] - 2.0 * shape.pad - 1;
    const int32_t now = box.max[m] - box.min[m] - 1;
    if (now > 0) growth = std::min(growth, steps / now);
  }
  return growth;
}

}  // namespace

absl::StatusOr<uint32_t> FindResolution(const BoxShape& shape, MeasureBox measure) {
  int fits = kMinResolution - 1, fails = kMaxResolution + 1;
  double guess = *std::min_element(shape.dims->begin(), shape.dims->end()) - 2.0 * shape.pad;
  while (fails - fits > 1) {
    const auto resolution = static_cast<int>(std::clamp(guess, fits + 1.0, fails - 1.0));
    const auto box = measure(static_cast<uint32_t>(resolution));
    if (!box.ok()) return box.status();
    if (!*box) return static_cast<uint32_t>(resolution);
    const auto shaped = ShapedBox(**box, shape, absl::StrCat("at --resolution ", resolution));
    if (!shaped.ok() && resolution == kMinResolution) return shaped.status();
    (shaped.ok() ? fits : fails) = resolution;
    guess = resolution * Growth(**box, shape);
  }
  return static_cast<uint32_t>(fits);
}

}  // namespace latvox::client
