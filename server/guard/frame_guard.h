// The bytes of one HTTP/2 connection from a client, judged before gRPC reads them.
#ifndef LATVOX_SERVER_GUARD_FRAME_GUARD_H_
#define LATVOX_SERVER_GUARD_FRAME_GUARD_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "absl/strings/string_view.h"
#include "server/guard/work_budget.h"

struct nghttp2_hd_inflater;

namespace latvox {

// Why a connection is closed.
enum class Offense {
  kPreface,      // it does not begin as HTTP/2
  kHeaderBlock,  // a header block is too long, too large when decoded, or wrong
  kNoSettings,   // it opens streams and does not acknowledge the server's settings, so gRPC's limits do not hold
  kFlood,        // its frames need more work than a connection may cause
  kHost,         // all connections of its host need more work than a host may cause, or they are too many
};
inline constexpr int kOffenses = 5;

// Returns a word for logs and metrics.
absl::string_view ToWord(Offense offense);

// The most that a header block may hold: its bytes, and its fields as RFC 9113 section 6.5.2 counts them. The server
// announces the same limit, so clients keep it by themselves.
inline constexpr uint32_t kMostHeaderBytes = 32768;
inline constexpr int kMostHeaderFields = 256;
// Streams that a client may open before it acknowledges the settings. They are the streams that it may have open later.
inline constexpr uint32_t kMostStreams = 256;

struct FrameWork {
  Work all = 0;
  Work unasked = 0;  // without calls that wait for answers of earlier calls
};

// Not thread-safe.
class FrameGuard {
 public:
  FrameGuard();
  ~FrameGuard();
  FrameGuard(FrameGuard&&) noexcept;

  // Judges the next bytes of the stream, in any pieces, and adds the work that they cause to `work`. Messages count
  // nothing, because they have limits elsewhere. After an offense the connection is over.
  std::optional<Offense> Receive(absl::string_view bytes, FrameWork& work);

 private:
  struct Inflater;

  std::optional<Offense> ReceivePreface(absl::string_view& bytes);
  std::optional<Offense> BeginFrame(FrameWork& work);
  std::optional<Offense> BeginHeaders(FrameWork& work);
  std::optional<Offense> ReceivePayload(absl::string_view& bytes);
  std::optional<Offense> ReceiveHeaderBlock(absl::string_view piece);

  size_t preface_ = 0;  // bytes of the preface so far
  unsigned char head_[9] = {};
  size_t head_bytes_ = 0;
  uint32_t payload_left_ = 0;
  uint8_t type_ = 0, flags_ = 0;

  bool acknowledged_ = false;
  uint32_t streams_ = 0;  // opened, up to kMostStreams

  bool in_block_ = false;       // between HEADERS and the end of its last CONTINUATION
  uint32_t priority_left_ = 0;  // bytes of a priority before the block
  uint32_t block_bytes_ = 0;    // of the block, by the heads of its frames
  uint32_t decoded_bytes_ = 0;  // of its fields
  int fields_ = 0;
  std::unique_ptr<Inflater> inflater_;  // made for the first block
};

}  // namespace latvox

#endif  // LATVOX_SERVER_GUARD_FRAME_GUARD_H_
