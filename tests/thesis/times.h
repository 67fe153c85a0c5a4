// The times of one round, as tables.
#ifndef LATVOX_TESTS_THESIS_TIMES_H_
#define LATVOX_TESTS_THESIS_TIMES_H_

#include <string>

#include "tests/thesis/plan.h"

namespace latvox::thesis {

// Writes timing-ROUND.csv, the tetrahedra of the timed angles, and orientation-ROUND.csv, one triangle parallel to a
// plane of lattice points and the same triangle across the volume (section 5.4). Rounds are processes of their own:
// where memory lies changes times, but not within a process.
void MeasureTimes(const Plan& plan, const std::string& round);

}  // namespace latvox::thesis

#endif  // LATVOX_TESTS_THESIS_TIMES_H_
