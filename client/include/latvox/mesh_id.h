// The name of a mesh on servers that store it.
#ifndef LATVOX_LATVOX_MESH_ID_H_
#define LATVOX_LATVOX_MESH_ID_H_

#include <array>
#include <cstdint>
#include <string_view>

#include "absl/status/statusor.h"
#include "latvox/export.h"

namespace latvox::client {

// Equal bytes have equal ids, and different bytes have different ids.
struct MeshId {
  std::array<uint8_t, 32> sha256{};  // of the encoded mesh
  uint64_t bytes = 0;                // length of the encoded mesh; 0: not known
  bool operator==(const MeshId&) const = default;
};

// Returns the id of these bytes. Errors: INTERNAL if the machine's libcrypto offers no SHA-256.
LATVOX_EXPORT absl::StatusOr<MeshId> MeshIdOf(std::string_view mesh_bytes);

}  // namespace latvox::client

#endif  // LATVOX_LATVOX_MESH_ID_H_
