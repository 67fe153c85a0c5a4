// The measurements of a run: everything, or for --quick a few angles and resolutions.
#ifndef LATVOX_TESTS_THESIS_PLAN_H_
#define LATVOX_TESTS_THESIS_PLAN_H_

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace latvox::thesis {

struct Plan {
  bool quick = false;
  std::string directory;                                    // of the tables
  std::vector<std::pair<std::string, std::string>> meshes;  // name, path
  std::vector<int32_t> resolutions, timed_resolutions, precision_resolutions, orientation_resolutions;
  std::vector<double> angles, timed_angles;
};

// A quick plan's resolutions and angles are some of the whole plan's, so that their counts must be equal.
Plan PlanFor(bool quick);

class Stopwatch {
 public:
  double Seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start_ = Clock::now();
};

}  // namespace latvox::thesis

#endif  // LATVOX_TESTS_THESIS_PLAN_H_
