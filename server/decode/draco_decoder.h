// Draco's triangle meshes, decoded here and now.
#ifndef LATVOX_SERVER_DECODE_DRACO_DECODER_H_
#define LATVOX_SERVER_DECODE_DRACO_DECODER_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "core/request/fields.h"
#include "server/base/limits.h"
#include "server/decode/mesh_decoder.h"

namespace latvox {

struct MeshSize {
  uint32_t vertices, triangles, quantization_bits;
};

// Takes a mesh piece by piece: Begin, all vertices, all attributes, all triangles. Pieces are not empty.
class MeshSink {
 public:
  static constexpr size_t kMaxPiece = 5460;  // elements; 64 KB

  virtual ~MeshSink() = default;
  virtual void Begin(const MeshSize& size) = 0;
  virtual void Vertices(absl::Span<const Vec3f> piece) = 0;
  virtual void Attributes(absl::Span<const uint32_t> piece) = 0;  // as TriangleMesh::attributes
  virtual void Triangles(absl::Span<const std::array<uint32_t, 3>> piece) = 0;
};

// Decodes one mesh into `sink`; if an error comes of it, what the sink has got is to be forgotten. Positions are the
// very floats that Draco's own decoder gives out. Takes the time and the memory that the bytes make it take.
// Errors: as MeshDecoder::Done.
absl::Status DecodeDraco(absl::string_view bytes, const Limits& limits, const FieldList& wanted, MeshSink& sink);

// The same, all at once.
absl::StatusOr<DecodedMesh> DecodeDraco(absl::string_view bytes, const Limits& limits, const FieldList& wanted = {});

// RESOURCE_EXHAUSTED with the reason OUT_OF_MEMORY.
absl::Status NoMemoryToDecode();
bool IsOutOfMemory(const absl::Status& status);

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_DRACO_DECODER_H_
