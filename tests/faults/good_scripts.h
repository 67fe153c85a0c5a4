// Requests that are right.
#ifndef LATVOX_TESTS_FAULTS_GOOD_SCRIPTS_H_
#define LATVOX_TESTS_FAULTS_GOOD_SCRIPTS_H_

#include <string>

#include "tests/faults/chance.h"
#include "tests/faults/raw_stream.h"

namespace latvox::faults {

// A good request of any of the four calls, with the mesh in some pieces, small enough to take milliseconds. Now and
// then it continues after a tile that is not there, which is INVALID_ARGUMENT.
Script GoodScript(const std::string& drc, Chance& chance);

}  // namespace latvox::faults

#endif  // LATVOX_TESTS_FAULTS_GOOD_SCRIPTS_H_
