// Cancelled curves end soon, with every algorithm.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/base/stop_signal.h"
#include "core/plane/pixelize.h"
#include "tests/unit/core/most_to_stop.h"

namespace latvox {
namespace {

struct Pixelizing {
  std::vector<Polyline> polylines;
  PlaneGrid grid;
  PixelizeOptions options;
  StopSource source;
  void Run() { Pixelize(polylines, grid, options, source.Signal()).IgnoreError(); }
  void Cancel() { source.Stop(); }
};

TEST(Cancelling, StopsLongCurvesWithEveryAlgorithm) {
  const PlaneGrid grid{PlaneLattice::Named(NamedPlaneLattice::kSquare), {0, 0}};
  const auto zigzag = [](uint32_t size) {
    const double side = size;
    Polyline line;
    for (int n = 0; n < 6; ++n) line.points.push_back({n % 2 * side, n * side / 6});
    return std::vector{line};
  };
  for (const auto& [algorithm, size] : {std::pair{LineAlgorithm::kCrossing, 60000U},
                                        {LineAlgorithm::kBruteForce, 6000U},
                                        {LineAlgorithm::kIbanez, 60000U}}) {
    const PixelizeOptions options{.algorithm = algorithm};
    const auto pixelizing = [&](const std::vector<Polyline>& lines) {
      return std::make_unique<Pixelizing>(lines, grid, options);
    };
    EXPECT_LT(MostToStop(size, zigzag, pixelizing), kPromised);
  }
}

}  // namespace
}  // namespace latvox
