#include "latvox/mesh_id.h"

#include <openssl/evp.h>

namespace latvox::client {

absl::StatusOr<MeshId> MeshIdOf(std::string_view mesh_bytes) {
  MeshId id{.bytes = mesh_bytes.size()};
  unsigned int size = 0;
  if (EVP_Digest(mesh_bytes.data(), mesh_bytes.size(), id.sha256.data(), &size, EVP_sha256(), nullptr) != 1 ||
      size != id.sha256.size()) {
    return absl::InternalError("libcrypto computes no SHA-256");
  }
  return id;
}

}  // namespace latvox::client
