// Draco's triangle meshes, decoded here and now.
#ifndef LATVOX_SERVER_DRACO_DECODER_H_
#define LATVOX_SERVER_DRACO_DECODER_H_

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "server/limits.h"
#include "server/mesh_decoder.h"

namespace latvox {

// Positions are the very floats that Draco's own decoder gives out. Takes the time and the memory that the bytes make
// it take. Errors: as MeshDecoder::Done.
absl::StatusOr<DecodedMesh> DecodeDraco(absl::string_view bytes, const Limits& limits);

}  // namespace latvox

#endif  // LATVOX_SERVER_DRACO_DECODER_H_
