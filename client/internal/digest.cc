#include "client/internal/digest.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <bit>
#include <cstdio>
#include <cstring>

namespace latvox::client {

// Brick's words are copied to and from the wire without conversion.
static_assert(std::endian::native == std::endian::little, "bricks are little-endian on the wire");

void Digest::Add(const Brick& brick, std::span<const float> values) { Add(brick, values.data(), values.size_bytes()); }

void Digest::Add(const Brick& brick, std::span<const uint32_t> attributes) {
  Add(brick, attributes.data(), attributes.size_bytes());
}

void Digest::Add(const Brick& brick, const void* values, size_t bytes) {
  constexpr size_t kIjkBytes = sizeof(brick.brick_ijk), kMaskBytes = sizeof(brick.mask);
  static_assert(kIjkBytes + kMaskBytes == 76);
  char hashed[kIjkBytes + kMaskBytes + 3 * 512 * sizeof(uint32_t)];
  std::memcpy(hashed, brick.brick_ijk.data(), kIjkBytes);
  std::memcpy(hashed + kIjkBytes, brick.mask.data(), kMaskBytes);
  if (bytes != 0) std::memcpy(hashed + kIjkBytes + kMaskBytes, values, bytes);
  const XXH128_hash_t hash = XXH3_128bits(hashed, kIjkBytes + kMaskBytes + bytes);
  Add(hash.high64, hash.low64);
}

void Digest::Add(const Digest& other) { Add(other.high_, other.low_); }

void Digest::Add(uint64_t high, uint64_t low) {
  low_ += low;
  high_ += high + (low_ < low ? 1 : 0);
}

std::string Digest::ToHex() const {
  char text[33];
  std::snprintf(text, sizeof(text), "%016llx%016llx", static_cast<unsigned long long>(high_),
                static_cast<unsigned long long>(low_));
  return text;
}

}  // namespace latvox::client
