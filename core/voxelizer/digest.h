// A digest of voxel sets. It does not depend on the way, the order or the number of parts in which they were computed.
#ifndef LATVOX_CORE_VOXELIZER_DIGEST_H_
#define LATVOX_CORE_VOXELIZER_DIGEST_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "core/brick/brick.h"

namespace latvox {

// The sum modulo 2^128, over all bricks, of XXH3-128 (seed 0) of 76 bytes: brick_ijk as three little-endian 32-bit
// integers, then the mask's eight words, little-endian. For sets without a common brick, the sum of their digests is
// the digest of their union.
class Digest {
 public:
  // `values`: one field of the brick's voxels, at most kMostFieldBytes for each. They are hashed after the 76 bytes.
  void Add(const Brick& brick, std::span<const std::byte> values = {});
  void Add(const Digest& other);
  std::string ToHex() const;  // 32 hexadecimal digits
  bool operator==(const Digest&) const = default;

 private:
  uint64_t high_ = 0, low_ = 0;
};

}  // namespace latvox

#endif  // LATVOX_CORE_VOXELIZER_DIGEST_H_
