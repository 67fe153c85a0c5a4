// Requests that are nearly right.
#ifndef LATVOX_TESTS_FAULTS_MUTATIONS_H_
#define LATVOX_TESTS_FAULTS_MUTATIONS_H_

#include <string>

#include "tests/faults/chance.h"
#include "tests/faults/raw_stream.h"

namespace latvox::faults {

// A good request (good_scripts.h) with something wrong with it, mostly: values of fields, order of messages, bytes of
// the mesh, bytes of messages. What is left of its work takes no longer than script.timeout, which is short.
Script MutatedScript(const std::string& drc, Chance& chance);

// `bytes` with some flipped, removed, repeated or put in.
std::string MutatedBytes(std::string bytes, Chance& chance);

// A whole connection with one such call, mutated as bytes: frames, headers, lengths.
std::string MutatedConnection(const Script& script, Chance& chance);

// A Draco stream of `size` bytes whose header is good and declares billions of triangles and points.
std::string DracoWithHugeCounts(bool edgebreaker, size_t size, Chance& chance);

}  // namespace latvox::faults

#endif  // LATVOX_TESTS_FAULTS_MUTATIONS_H_
