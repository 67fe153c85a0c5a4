// Correct requests.
#ifndef LATVOX_TESTS_FAULTS_GOOD_SCRIPTS_H_
#define LATVOX_TESTS_FAULTS_GOOD_SCRIPTS_H_

#include <string>

#include "tests/faults/chance.h"
#include "tests/faults/raw_stream.h"

namespace latvox::faults {

// Returns a correct request of any call, with the mesh in some pieces, small enough to take milliseconds.
// Now and then it resumes after a tile that does not exist, or an upload at a later offset, which is INVALID_ARGUMENT.
Script GoodScript(const std::string& drc, Chance& chance);

}  // namespace latvox::faults

#endif  // LATVOX_TESTS_FAULTS_GOOD_SCRIPTS_H_
