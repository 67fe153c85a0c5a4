#include "core/voxelizer/digest.h"

#include <array>
#include <bit>
#include <cstring>

#include "absl/strings/str_format.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace latvox {

static_assert(std::endian::native == std::endian::little, "the digest hashes little-endian memory");

void Digest::Add(const Brick& brick, std::span<const float> values) {
  constexpr size_t kBrickBytes = sizeof(brick.brick_ijk) + sizeof(brick.mask);
  static_assert(kBrickBytes == 76);
  std::array<char, kBrickBytes + 512 * sizeof(float)> bytes;
  std::memcpy(bytes.data(), brick.brick_ijk.data(), sizeof(brick.brick_ijk));
  std::memcpy(bytes.data() + sizeof(brick.brick_ijk), brick.mask.data(), sizeof(brick.mask));
  if (!values.empty()) std::memcpy(bytes.data() + kBrickBytes, values.data(), values.size_bytes());
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), kBrickBytes + values.size_bytes());
  Digest one;
  one.low_ = hash.low64;
  one.high_ = hash.high64;
  Add(one);
}

void Digest::Add(const Digest& other) {
  low_ += other.low_;
  high_ += other.high_ + (low_ < other.low_ ? 1 : 0);
}

std::string Digest::ToHex() const { return absl::StrFormat("%016x%016x", high_, low_); }

}  // namespace latvox
