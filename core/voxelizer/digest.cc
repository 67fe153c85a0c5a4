#include "core/voxelizer/digest.h"

#include <array>
#include <bit>
#include <cstring>

#include "absl/strings/str_format.h"
#include "core/request/fields.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace latvox {

static_assert(std::endian::native == std::endian::little, "the digest hashes little-endian memory");

void Digest::Add(const Brick& brick, std::span<const std::byte> values) {
  constexpr size_t kBrickBytes = sizeof(brick.brick_ijk) + sizeof(brick.mask);
  static_assert(kBrickBytes == 76);
  std::array<char, kBrickBytes + 512 * kMostFieldBytes> hashed;
  std::memcpy(hashed.data(), brick.brick_ijk.data(), sizeof(brick.brick_ijk));
  std::memcpy(hashed.data() + sizeof(brick.brick_ijk), brick.mask.data(), sizeof(brick.mask));
  if (!values.empty()) std::memcpy(hashed.data() + kBrickBytes, values.data(), values.size());
  const XXH128_hash_t hash = XXH3_128bits(hashed.data(), kBrickBytes + values.size());
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
