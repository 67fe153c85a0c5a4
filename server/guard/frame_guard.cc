#include "server/guard/frame_guard.h"

#include <nghttp2/nghttp2.h>

#include <algorithm>
#include <cstring>

namespace latvox {
namespace {

constexpr absl::string_view kPreface = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";
constexpr size_t kHeadBytes = 9;
constexpr uint32_t kPriorityBytes = 5;
// The weight of a field's bookkeeping, by RFC 9113 section 6.5.2.
constexpr uint32_t kFieldBytes = 32;
// gRPC parses an unfinished block again with each read: so long for a byte, if it is compressed, and for the read.
constexpr Work kParsedByte = 8, kParsedRead = 1000;
// For a call. After the first calls of a connection, each waits for the answer of an earlier one.
constexpr Work kCall = 60'000;

void Add(Work more, FrameWork& work) {
  work.all += more;
  work.unasked += more;
}

enum FrameType : uint8_t {
  kData,
  kHeaders,
  kPriority,
  kResetStream,
  kSettings,
  kPushPromise,
  kPing,
  kGoAway,
  kWindowUpdate,
  kContinuation
};
enum FrameFlag : uint8_t { kAcknowledged = 1, kEndHeaders = 4, kPadded = 8, kHasPriority = 32 };

// The time that gRPC 1.51 needs for a frame, rounded up; see tests/notes/2026-11-guard.md.
Work WorkOf(uint8_t type, uint32_t length) {
  constexpr uint32_t kSmall = 64, kSetting = 6;
  switch (type) {
    case kData:
      return length < kSmall ? 500 : 0;
    case kHeaders:
      return 0;
    case kResetStream:
      return 100'000;
    case kSettings:
      return 20'000 + 1000 * static_cast<Work>(length / kSetting);
    case kPing:
      return 10'000;
    case kContinuation:
      return 2000;
    default:
      return 500;
  }
}

}  // namespace

absl::string_view ToWord(Offense offense) {
  switch (offense) {
    case Offense::kPreface:
      return "preface";
    case Offense::kHeaderBlock:
      return "header_block";
    case Offense::kNoSettings:
      return "no_settings";
    case Offense::kFlood:
      return "flood";
    case Offense::kHost:
      return "host";
  }
  return "";
}

// The decoder of header blocks, which keeps the client's table of fields.
struct FrameGuard::Inflater {
  Inflater() { nghttp2_hd_inflate_new(&inflater); }
  ~Inflater() { nghttp2_hd_inflate_del(inflater); }

  nghttp2_hd_inflater* inflater = nullptr;
};

FrameGuard::FrameGuard() = default;
FrameGuard::~FrameGuard() = default;
FrameGuard::FrameGuard(FrameGuard&&) noexcept = default;

std::optional<Offense> FrameGuard::Receive(absl::string_view bytes, FrameWork& work) {
  if (preface_ < kPreface.size()) {
    if (auto offense = ReceivePreface(bytes)) return offense;
  }
  while (!bytes.empty()) {
    if (head_bytes_ < kHeadBytes) {
      const size_t count = std::min(kHeadBytes - head_bytes_, bytes.size());
      std::memcpy(head_ + head_bytes_, bytes.data(), count);
      head_bytes_ += count;
      bytes.remove_prefix(count);
      if (head_bytes_ < kHeadBytes) break;
      if (auto offense = BeginFrame(work)) return offense;
    }
    if (auto offense = ReceivePayload(bytes)) return offense;
  }
  if (in_block_) Add(kParsedRead + kParsedByte * block_bytes_, work);
  return std::nullopt;
}

std::optional<Offense> FrameGuard::ReceivePreface(absl::string_view& bytes) {
  const size_t count = std::min(kPreface.size() - preface_, bytes.size());
  if (bytes.substr(0, count) != kPreface.substr(preface_, count)) return Offense::kPreface;
  preface_ += count;
  bytes.remove_prefix(count);
  return std::nullopt;
}

// Judges the head of a frame. Frames in the wrong order are left to gRPC, except within a header block.
std::optional<Offense> FrameGuard::BeginFrame(FrameWork& work) {
  payload_left_ = static_cast<uint32_t>(head_[0]) << 16 | static_cast<uint32_t>(head_[1]) << 8 | head_[2];
  type_ = head_[3];
  flags_ = head_[4];
  Add(WorkOf(type_, payload_left_), work);
  if (in_block_ != (type_ == kContinuation)) return Offense::kHeaderBlock;
  if (type_ == kSettings && (flags_ & kAcknowledged) != 0) acknowledged_ = true;
  if (type_ == kHeaders) return BeginHeaders(work);
  if (type_ == kContinuation) {
    block_bytes_ += payload_left_;
    if (block_bytes_ > kMostHeaderBytes) return Offense::kHeaderBlock;
  }
  return std::nullopt;
}

// gRPC takes padding for a part of the block, so both would read different fields.
std::optional<Offense> FrameGuard::BeginHeaders(FrameWork& work) {
  if (streams_ < kMostStreams) {
    ++streams_;
    Add(kCall, work);
  } else if (acknowledged_) {
    work.all += kCall;
  } else {
    return Offense::kNoSettings;
  }
  if ((flags_ & kPadded) != 0) return Offense::kHeaderBlock;
  priority_left_ = (flags_ & kHasPriority) != 0 ? kPriorityBytes : 0;
  if (payload_left_ < priority_left_ || payload_left_ - priority_left_ > kMostHeaderBytes) return Offense::kHeaderBlock;
  in_block_ = true;
  block_bytes_ = payload_left_ - priority_left_;
  decoded_bytes_ = 0;
  fields_ = 0;
  if (!inflater_) inflater_ = std::make_unique<Inflater>();
  return std::nullopt;
}

// Takes bytes of the current frame, which may be empty.
std::optional<Offense> FrameGuard::ReceivePayload(absl::string_view& bytes) {
  absl::string_view piece = bytes.substr(0, payload_left_);
  bytes.remove_prefix(piece.size());
  payload_left_ -= static_cast<uint32_t>(piece.size());
  if (in_block_) {
    const size_t priority = std::min<size_t>(priority_left_, piece.size());
    priority_left_ -= static_cast<uint32_t>(priority);
    piece.remove_prefix(priority);
    if (auto offense = ReceiveHeaderBlock(piece)) return offense;
  }
  if (payload_left_ > 0) return std::nullopt;
  head_bytes_ = 0;
  if ((flags_ & kEndHeaders) != 0 && in_block_) in_block_ = false;
  return std::nullopt;
}

// Decodes the next bytes of a block, and counts its fields.
std::optional<Offense> FrameGuard::ReceiveHeaderBlock(absl::string_view piece) {
  const bool is_last = payload_left_ == 0 && (flags_ & kEndHeaders) != 0;
  const auto* next = reinterpret_cast<const uint8_t*>(piece.data());
  size_t left = piece.size();
  for (;;) {
    nghttp2_nv field;
    int told = 0;
    const ssize_t read = nghttp2_hd_inflate_hd2(inflater_->inflater, &field, &told, next, left, is_last ? 1 : 0);
    if (read < 0) return Offense::kHeaderBlock;
    next += read;
    left -= static_cast<size_t>(read);
    if ((told & NGHTTP2_HD_INFLATE_EMIT) != 0) {
      decoded_bytes_ += static_cast<uint32_t>(field.namelen + field.valuelen) + kFieldBytes;
      if (++fields_ > kMostHeaderFields || decoded_bytes_ > kMostHeaderBytes) return Offense::kHeaderBlock;
      continue;
    }
    if ((told & NGHTTP2_HD_INFLATE_FINAL) != 0) nghttp2_hd_inflate_end_headers(inflater_->inflater);
    return std::nullopt;
  }
}

}  // namespace latvox
