#include "client/grid/file_uuid.h"

#include <cstdint>

#include "absl/strings/str_format.h"

namespace latvox::client {

std::string FileUuid::Text() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(&state_);
  constexpr uint64_t kVersion = 8, kVariant = uint64_t{2} << 62;
  const uint64_t high = (hash.high64 & ~uint64_t{0xF000}) | kVersion << 12, low = hash.low64 >> 2 | kVariant;
  return absl::StrFormat("%08x-%04x-%04x-%04x-%012x", high >> 32, high >> 16 & 0xFFFF, high & 0xFFFF, low >> 48,
                         low & 0xFFFFFFFFFFFF);
}

}  // namespace latvox::client
