#include "client/internal/digest.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <bit>
#include <cstdio>
#include <cstring>

namespace latvox::client {
namespace {

// A voxel has at most a number for each neighbor.
constexpr size_t kMostFieldBytes = sizeof(float) * kMostNeighbors;

}  // namespace

// Brick's words are copied to and from the wire without conversion.
static_assert(std::endian::native == std::endian::little, "bricks are little-endian on the wire");

void Digest::Add(const Brick& brick, std::span<const std::byte> values) {
  constexpr size_t kIjkBytes = sizeof(brick.brick_ijk), kMaskBytes = sizeof(brick.mask);
  static_assert(kIjkBytes + kMaskBytes == 76);
  char hashed[kIjkBytes + kMaskBytes + 512 * kMostFieldBytes];
  std::memcpy(hashed, brick.brick_ijk.data(), kIjkBytes);
  std::memcpy(hashed + kIjkBytes, brick.mask.data(), kMaskBytes);
  if (!values.empty()) std::memcpy(hashed + kIjkBytes + kMaskBytes, values.data(), values.size());
  const XXH128_hash_t hash = XXH3_128bits(hashed, kIjkBytes + kMaskBytes + values.size());
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
