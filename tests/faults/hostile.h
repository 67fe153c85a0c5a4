// Hostile clients.
#ifndef LATVOX_TESTS_FAULTS_HOSTILE_H_
#define LATVOX_TESTS_FAULTS_HOSTILE_H_

#include <string>

#include "tests/faults/chance.h"
#include "tests/faults/jobs.h"
#include "tests/faults/raw_stream.h"
#include "tests/faults/records.h"

namespace latvox::faults {

// Does one hostile thing. Fills in `job` (the thing done), `outcome` and `detail`. The outcome is "rejected" if the
// server answered with an error that is not its own defect, or with the result of the request.
void BeHostile(const std::string& address, grpc::Channel& channel, const Job& job, Chance& chance, Record& record);

// Returns whether this answer to a bad request keeps the server's promises: no INTERNAL, no UNKNOWN.
bool IsFairAnswer(const grpc::Status& status);

}  // namespace latvox::faults

#endif  // LATVOX_TESTS_FAULTS_HOSTILE_H_
