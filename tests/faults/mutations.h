// Nearly right requests.
#ifndef LATVOX_TESTS_FAULTS_MUTATIONS_H_
#define LATVOX_TESTS_FAULTS_MUTATIONS_H_

#include <string>

#include "tests/faults/chance.h"
#include "tests/faults/raw_stream.h"

namespace latvox::faults {

// Returns a correct request (good_scripts.h), mostly with a mistake: in values of fields, order of messages, bytes of
// the mesh or bytes of messages. The rest of its work takes at most script.timeout, which is short.
Script MutatedScript(const std::string& drc, Chance& chance);

// Returns `bytes` with some flipped, removed, repeated or inserted.
std::string MutatedBytes(std::string bytes, Chance& chance);

// Returns a whole connection with one such call, mutated as bytes: frames, headers, lengths.
std::string MutatedConnection(const Script& script, Chance& chance);

// Returns a Draco stream of `size` bytes. Its header is valid and declares billions of triangles and points.
std::string DracoWithHugeCounts(bool edgebreaker, size_t size, Chance& chance);

}  // namespace latvox::faults

#endif  // LATVOX_TESTS_FAULTS_MUTATIONS_H_
