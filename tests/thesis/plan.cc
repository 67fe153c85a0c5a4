#include "tests/thesis/plan.h"

#include "tests/thesis/experiment.h"

namespace latvox::thesis {

Plan PlanFor(bool quick) {
  constexpr int32_t kTop = 200;
  Plan plan;
  plan.quick = quick;
  const std::vector<double> angles = Angles();
  for (int32_t resolution = 10; resolution <= kTop; resolution += 10) {
    if (!quick || resolution <= 80 || resolution == kTop) plan.resolutions.push_back(resolution);
  }
  plan.timed_resolutions = quick ? std::vector<int32_t>{10, 20, 40, 60, kTop} : plan.resolutions;
  plan.precision_resolutions = quick ? std::vector<int32_t>{50, kTop} : std::vector<int32_t>{50, 100, 150, kTop};
  plan.orientation_resolutions = {50, 100, kTop};
  for (size_t n = 0; n < angles.size(); n += quick ? 12 : 1) plan.angles.push_back(angles[n]);
  for (size_t n = 3; n < angles.size(); n += quick ? 72 : 17) plan.timed_angles.push_back(angles[n]);
  return plan;
}

}  // namespace latvox::thesis
