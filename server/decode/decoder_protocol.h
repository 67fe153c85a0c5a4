// What the server and a decoder process say to each other, over one Unix stream socket. Host byte order: both are the
// same program.
//
//   server -> process, for each mesh:  DecodeRequest, then the encoded bytes
//   process -> server, once:           kReady, or kError
//   process -> server, for each mesh:  kMesh, kVertices, ..., kAttributes, ..., kTriangles, ..., kDone; or kError at
//   any point
//
// A socket, not shared memory: what has been received can not change any more, a process can hold back no more than a
// socket's buffer, and one that dies leaves no mapping behind to fault on. It is the fastest, too: 16 MB take 2.6 ms
// through a socket, 4.5 through a pipe of 1 MiB, 6.5 by pwrite and pread of a memory file; and they are received while
// the process works on what follows.
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
  uint64_t bytes;  // that follow
  uint64_t max_triangles, max_vertices;
  FieldList attributes;  // that are wanted
};

enum class FrameKind : uint32_t {
  kReady,      // ReadyFrame
  kMesh,       // MeshFrame
  kVertices,   // three floats each
  kTriangles,  // three 32-bit indices each
  kDone,       // nothing
  kError,      // EncodeError
  kAttributes  // 32-bit numbers
};

struct FrameHeader {
  FrameKind kind;
  uint32_t bytes;  // that follow: a multiple of 4, at most kMaxFrameBytes
};

struct ReadyFrame {
  uint64_t address_space_bytes;  // what the process takes before it has decoded anything
};

struct MeshFrame {
  uint32_t vertices, triangles, quantization_bits;
};

// A MeshSink's largest piece. Small enough to stay in a core's own caches on the way.
inline constexpr size_t kMaxFrameBytes = MeshSink::kMaxPiece * 12;

// A status as the bytes of a frame, and back: code, message and cause. What comes back is INVALID_ARGUMENT or
// RESOURCE_EXHAUSTED in printable ASCII, whatever the bytes are.
std::string EncodeError(const absl::Status& status);
absl::Status DecodeError(absl::string_view frame);

// Puts a mesh together from a process that may have been taken over by a hostile file: it may send anything.
class MeshReceiver {
 public:
  //   wanted   what each vertex is to have, and nothing else
  explicit MeshReceiver(const Limits& limits, MeshDecoder::Reserve reserve = {}, const FieldList& wanted = {})
      : limits_(limits), reserve_(std::move(reserve)), wanted_(wanted) {}

  enum class Progress {
    kMore,     // so far, so good
    kDone,     // result() is complete
    kRefused,  // there is no memory for the mesh: result() says why; the process goes on to send it
    kBroken,   // this is not what a decoder of ours sends
  };

  // Receives the next frame; `frame` is aligned to 4 bytes. Not after anything but kMore.
  Progress Receive(FrameKind kind, absl::string_view frame);

  // After kDone: the mesh, which CheckMesh accepts and which is within the limits, or the process's error.
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
