// Encoded bytes -> triangle mesh: the seam behind which foreign bytes meet a codec.
#ifndef LATVOX_SERVER_MESH_DECODER_H_
#define LATVOX_SERVER_MESH_DECODER_H_

#include <cstdint>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/mesh/mesh.h"
#include "server/limits.h"

namespace latvox {

struct DecodedMesh {
  TriangleMesh mesh;               // Validate(mesh) is OK
  uint32_t quantization_bits = 0;  // of POSITION; 0: not quantized
};

// Threads: Decode may run on many threads at once.
//
// A decode can neither be interrupted nor, from the header alone, be bounded in memory: a hostile file within all
// limits can still make a codec allocate gigabytes. An implementation may therefore decode in a process of its own;
// callers see only this interface.
class MeshDecoder {
 public:
  virtual ~MeshDecoder() = default;

  // Errors: INVALID_ARGUMENT for bytes that are not one good mesh; RESOURCE_EXHAUSTED for a mesh over `limits` or the
  // memory there is.
  virtual absl::StatusOr<DecodedMesh> Decode(absl::string_view bytes, const Limits& limits) const = 0;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_MESH_DECODER_H_
