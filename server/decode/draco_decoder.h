// Decodes Draco's triangle meshes in this process.
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
#include "server/decode/draco_header.h"
#include "server/decode/mesh_decoder.h"

namespace latvox {

struct MeshSize {
  uint32_t vertices, triangles, quantization_bits;
};

// Receives a mesh in pieces: Declare, Begin, all vertices, all attributes, all triangles. No piece is empty.
class MeshSink {
 public:
  static constexpr size_t kMaxPiece = 5460;  // elements; 64 KB

  virtual ~MeshSink() = default;
  virtual void Declare(const DeclaredCounts& counts) = 0;  // before the costly part of the decode
  virtual void Begin(const MeshSize& size) = 0;
  virtual void Vertices(absl::Span<const Vec3f> piece) = 0;
  virtual void Attributes(absl::Span<const uint32_t> piece) = 0;  // in the form of TriangleMesh::attributes
  virtual void Triangles(absl::Span<const std::array<uint32_t, 3>> piece) = 0;
};

// Decodes one mesh into `sink`; after an error, the content of the sink is invalid. Positions are the same floats as
// those of Draco's own decoder. The cost in time and memory is up to the bytes. Errors: as MeshDecoder::Done.
absl::Status DecodeDraco(absl::string_view bytes, const Limits& limits, const FieldList& wanted, MeshSink& sink);

// Does the same, and returns the whole mesh.
absl::StatusOr<DecodedMesh> DecodeDraco(absl::string_view bytes, const Limits& limits, const FieldList& wanted = {});

// Returns RESOURCE_EXHAUSTED with the reason OUT_OF_MEMORY.
absl::Status NoMemoryToDecode();
bool IsOutOfMemory(const absl::Status& status);

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_DRACO_DECODER_H_
