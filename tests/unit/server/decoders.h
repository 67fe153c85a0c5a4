// Decoder processes for the server's tests.
#ifndef LATVOX_TESTS_UNIT_SERVER_DECODERS_H_
#define LATVOX_TESTS_UNIT_SERVER_DECODERS_H_

#include "server/decode/decoder_process.h"
#include "server/decode/decoder_sandbox.h"

namespace latvox {

// Two processes of the latvoxd beside the tests, whatever is built. A sanitizer takes address space by the terabyte:
// with it, memory is not limited.
inline DecoderOptions TestDecoders() {
  DecoderOptions options;
  options.program = LATVOXD;
  options.processes = 2;
  options.memory = kUnderSanitizer ? kNoMemoryLimit : uint64_t{1} << 30;
  return options;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_SERVER_DECODERS_H_
