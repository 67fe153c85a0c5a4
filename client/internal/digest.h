// The digest of a voxel set, computed from the received bricks, to compare it with the server's.
#ifndef LATVOX_CLIENT_INTERNAL_DIGEST_H_
#define LATVOX_CLIENT_INTERNAL_DIGEST_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "latvox/types.h"

namespace latvox::client {

// Certificate.digest of the protocol: the sum modulo 2^128, over all bricks, of XXH3-128 (seed 0) of 76 bytes, which
// are brick_ijk and the mask's words, little-endian. For FieldCertificate.digest, the brick's values follow them. The
// order of bricks does not matter.
class Digest {
 public:
  void Add(const Brick& brick, std::span<const std::byte> values = {});  // those of one field
  void Add(const Digest& other);                                         // all bricks of the other
  std::string ToHex() const;                                             // 32 hexadecimal digits

 private:
  void Add(uint64_t high, uint64_t low);

  uint64_t high_ = 0, low_ = 0;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_INTERNAL_DIGEST_H_
