// Foreign drawings. Every input gives a clean status, or finite polylines.
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "client/tool/curve/svg_curves.h"
#include "client/tool/curve/text_curves.h"

namespace {

void Check(const absl::StatusOr<std::vector<latvox::client::Polyline>>& polylines) {
  if (!polylines.ok()) return;
  for (const auto& polyline : *polylines) {
    if (polyline.points.empty()) std::abort();
    for (const auto& [x, y] : polyline.points) {
      if (!std::isfinite(x) || !std::isfinite(y)) std::abort();
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const absl::string_view text(reinterpret_cast<const char*>(data), size);
  Check(latvox::client::ParseSvg(text));
  Check(latvox::client::ParseText(text));
  return 0;
}
