// Draco's triangle meshes, decoded in this process.
#ifndef LATVOX_SERVER_DRACO_DECODER_H_
#define LATVOX_SERVER_DRACO_DECODER_H_

#include "server/mesh_decoder.h"

namespace latvox {

// Positions are the very floats that Draco's own decoder gives out.
class DracoDecoder final : public MeshDecoder {
 public:
  absl::StatusOr<DecodedMesh> Decode(absl::string_view bytes, const Limits& limits) const override;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_DRACO_DECODER_H_
