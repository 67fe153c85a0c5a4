// Messages between the server and a decoder process, over one Unix stream socket. They have the host's byte order,
// because both are the same program.
//
//   server -> process, for each mesh:  DecodeRequest, then the encoded bytes
//   process -> server, once:           kReady, or kError
//   process -> server, for each mesh:  kDeclaration, kMesh, kVertices, ..., kAttributes, ..., kTriangles, ..., kDone;
//   or kError at any point
//
// Why a socket, and not shared memory: received bytes cannot change any more, a process can hold back no more than a
// socket's buffer, and a dead process leaves no mapping that faults. It is also the fastest way. 16 MB take 2.6 ms
// through a socket, 4.5 ms through a pipe of 1 MiB, 6.5 ms by pwrite and pread of a memory file. And the server
// receives them while the process works on the next ones.
#ifndef LATVOX_SERVER_DECODE_DECODER_PROTOCOL_H_
#define LATVOX_SERVER_DECODE_DECODER_PROTOCOL_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/request/fields.h"
#include "server/base/limits.h"
#include "server/decode/draco_decoder.h"
#include "server/decode/mesh_decoder.h"

namespace latvox {

struct DecodeRequest {
  uint64_t bytes;  // the length of the encoded mesh that follows
  uint64_t max_triangles, max_vertices;
  FieldList attributes;  // the requested ones
};

enum class FrameKind : uint32_t {
  kReady,       // ReadyFrame
  kMesh,        // MeshFrame
  kVertices,    // three floats each
  kTriangles,   // three 32-bit indices each
  kDone,        // nothing
  kError,       // EncodeError
  kAttributes,  // 32-bit numbers
  kDeclaration  // DeclarationFrame
};

struct FrameHeader {
  FrameKind kind;
  uint32_t bytes;  // the length of the content: a multiple of 4, at most kMaxFrameBytes
};

struct ReadyFrame {
  uint64_t address_space_bytes;  // of the process before its first decode
};

// What the header declares. The limits of the decode follow it.
struct DeclarationFrame {
  uint64_t triangles, points;
};

struct MeshFrame {
  uint32_t vertices, triangles, quantization_bits;
};

// A MeshSink's largest piece. It is small enough to stay in a core's own caches on the way.
inline constexpr size_t kMaxFrameBytes = MeshSink::kMaxPiece * 12;

// Converts a status to the bytes of a frame, and back: code, message and cause. Whatever the bytes are, the result is
// INVALID_ARGUMENT or RESOURCE_EXHAUSTED in printable ASCII.
std::string EncodeError(const absl::Status& status);
absl::Status DecodeError(absl::string_view frame);

// Assembles a mesh from a process that a hostile file may have taken over: it may send anything.
class MeshReceiver {
 public:
  //   wanted   the attributes of each vertex, and no others
  explicit MeshReceiver(const Limits& limits, MeshDecoder::Reserve reserve = {}, const FieldList& wanted = {})
      : limits_(limits), reserve_(std::move(reserve)), wanted_(wanted) {}

  enum class Progress {
    kMore,     // valid so far
    kDone,     // result() is complete
    kRefused,  // there is no memory for the mesh: result() has the reason; the process goes on to send it
    kBroken,   // a correct decoder does not send this
  };

  // Receives the next frame; `frame` is aligned to 4 bytes. Call it only after kMore.
  Progress Receive(FrameKind kind, absl::string_view frame);

  // After kDone: the mesh, accepted by CheckMesh and within the limits, or the process's error.
  absl::StatusOr<DecodedMesh> result() &&;

 private:
  Progress ReceiveHead(absl::string_view frame);
  Progress ReceiveVertices(absl::string_view frame);
  Progress ReceiveTriangles(absl::string_view frame);
  Progress ReceiveAttributes(absl::string_view frame);
  size_t attributes() const { return size_t{head_->vertices} * wanted_.size(); }

  const Limits limits_;
  const MeshDecoder::Reserve reserve_;
  const FieldList wanted_;
  std::optional<MeshFrame> head_;
  DecodedMesh mesh_;
  absl::Status error_;
};

}  // namespace latvox

#endif  // LATVOX_SERVER_DECODE_DECODER_PROTOCOL_H_
