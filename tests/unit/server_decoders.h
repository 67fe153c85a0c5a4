// Decoder processes for the server's tests.
#ifndef LATVOX_TESTS_UNIT_SERVER_DECODERS_H_
#define LATVOX_TESTS_UNIT_SERVER_DECODERS_H_

#include "server/decoder_process.h"

namespace latvox {

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kAddressSanitizer = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool kAddressSanitizer = true;
#else
inline constexpr bool kAddressSanitizer = false;
#endif
#else
inline constexpr bool kAddressSanitizer = false;
#endif

// Two processes of the latvoxd beside the tests, whatever is built. AddressSanitizer takes address space by the
// terabyte: with it, memory is not limited.
inline DecoderOptions TestDecoders() {
  DecoderOptions options;
  options.program = LATVOXD;
  options.processes = 2;
  options.memory = kAddressSanitizer ? kNoMemoryLimit : uint64_t{1} << 30;
  return options;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_SERVER_DECODERS_H_
