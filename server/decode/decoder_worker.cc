#include "server/decode/decoder_worker.h"

#include <malloc.h>
#include <sys/prctl.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cstring>
#include <memory>
#include <new>

#include "absl/strings/numbers.h"
#include "absl/strings/string_view.h"
#include "core/base/kept_memory.h"
#include "deploy/process/child.h"
#include "server/decode/decoder_protocol.h"
#include "server/decode/decoder_sandbox.h"
#include "server/decode/draco_decoder.h"

namespace latvox {
namespace {

constexpr int kLost = 1;  // exit status: the server is gone, or has sent an invalid message

// Keeps freed memory for later decodes. Without it, a large decode spends a quarter of its time on page faults. It wins
// back half of the cost of isolation.
void KeepMemory() {
  constexpr int kKeptBytes = 64 << 20;
  KeepHeap(kKeptBytes);
  KeepJobMemory(kKeptBytes / 2);
  mallopt(M_ARENA_MAX, 1);  // at the limit of memory, malloc would try another arena by forbidden system calls
}

// There is nobody left to tell.
[[noreturn]] void GiveUp() { _exit(kLost); }

// Returns whether all bytes came; false at the end of the stream.
bool ReadAll(void* to, size_t bytes) {
  char* at = static_cast<char*>(to);
  while (bytes > 0) {
    const ssize_t got = read(kDecoderChannel, at, bytes);
    if (got <= 0) return false;
    at += got;
    bytes -= static_cast<size_t>(got);
  }
  return true;
}

void Send(FrameKind kind, const void* payload, size_t bytes) {
  FrameHeader header{kind, static_cast<uint32_t>(bytes)};
  iovec parts[2] = {{&header, sizeof(header)}, {const_cast<void*>(payload), bytes}};
  for (size_t n = 0; n < 2;) {
    ssize_t sent = writev(kDecoderChannel, parts + n, static_cast<int>(2 - n));
    if (sent < 0) GiveUp();
    for (; n < 2 && static_cast<size_t>(sent) >= parts[n].iov_len; ++n) sent -= static_cast<ssize_t>(parts[n].iov_len);
    if (n == 2) break;
    parts[n].iov_base = static_cast<char*>(parts[n].iov_base) + sent;
    parts[n].iov_len -= static_cast<size_t>(sent);
  }
}

void SendError(const absl::Status& status) {
  const std::string frame = EncodeError(status);
  Send(FrameKind::kError, frame.data(), frame.size());
}

// Sends the mesh on as it is decoded.
class SendingSink final : public MeshSink {
 public:
  void Declare(const DeclaredCounts& counts) override {
    const DeclarationFrame frame{counts.triangles, counts.points};
    Send(FrameKind::kDeclaration, &frame, sizeof(frame));
  }
  void Begin(const MeshSize& size) override {
    const MeshFrame frame{size.vertices, size.triangles, size.quantization_bits};
    Send(FrameKind::kMesh, &frame, sizeof(frame));
  }
  void Vertices(absl::Span<const Vec3f> vertices) override {
    Send(FrameKind::kVertices, vertices.data(), vertices.size() * sizeof(Vec3f));
  }
  void Attributes(absl::Span<const uint32_t> attributes) override {
    Send(FrameKind::kAttributes, attributes.data(), attributes.size() * sizeof(uint32_t));
  }
  void Triangles(absl::Span<const std::array<uint32_t, 3>> triangles) override {
    Send(FrameKind::kTriangles, triangles.data(), triangles.size() * sizeof(triangles[0]));
  }
};

void DecodeOne(const DecodeRequest& request) {
  const std::unique_ptr<char[]> bytes(new (std::nothrow) char[request.bytes]);
  if (!bytes) {
    SendError(NoMemoryToDecode());
    GiveUp();  // the parts sent so far are in the way of the next request
  }
  if (!ReadAll(bytes.get(), request.bytes)) GiveUp();
  SendingSink sink;
  Limits limits;
  limits.max_triangles = request.max_triangles;
  limits.max_vertices = request.max_vertices;
  const absl::string_view view(bytes.get(), request.bytes);
  const absl::Status status = DecodeDraco(view, limits, request.attributes, sink);
  if (status.ok()) return Send(FrameKind::kDone, nullptr, 0);
  SendError(status);
  if (IsOutOfMemory(status)) GiveUp();  // Draco does not promise to have freed its memory
}

absl::Status Confine(const char* const* arguments) {
  pid_t parent = 0;
  uint64_t memory = 0;
  if (!absl::SimpleAtoi(arguments[0], &parent) || !absl::SimpleAtoi(arguments[1], &memory)) {
    return absl::InternalError("wrong arguments");
  }
  if (absl::Status status = LimitSelf(parent, memory); !status.ok()) return status;
  const absl::Status status = ForbidSystemCalls(kDecoderChannel);
  return absl::string_view(arguments[2]) == "unconfined" && absl::IsUnavailable(status) ? absl::OkStatus() : status;
}

}  // namespace

std::optional<int> RunIfDecoderProcess(int argc, const char* const* argv) {
  if (argc != 5 || absl::string_view(argv[1]) != kDecoderArgument) return std::nullopt;
  prctl(PR_SET_NAME, "latvoxd-decoder");
  KeepMemory();
  const uint64_t in_use = AddressesInUse();
  if (absl::Status status = Confine(argv + 2); !status.ok()) {
    SendError(status);
    return kLost;
  }
  const ReadyFrame ready{in_use};
  Send(FrameKind::kReady, &ready, sizeof(ready));
  for (DecodeRequest request; ReadAll(&request, sizeof(request));) DecodeOne(request);
  // Without destructors, because they may make system calls that are now forbidden.
  _exit(0);
}

}  // namespace latvox
