#include "client/tool/output/deflater.h"

#include <zlib.h>

#include <utility>

#include "absl/strings/str_cat.h"

namespace latvox::client {
namespace {

// The heads of streams of the fastest level: that of zlib, and that of gzip without a name and a date, from Unix.
constexpr std::string_view kZlibHead("\x78\x01", 2), kGzipHead("\x1F\x8B\x08\0\0\0\0\0\x04\x03", 10);

// Returns the four bytes of a number. zlib has the highest first, gzip the lowest.
std::string FourBytes(uint32_t number, bool highest_first) {
  std::string bytes;
  for (int n = 0; n < 4; ++n) bytes += static_cast<char>(number >> 8 * (highest_first ? 3 - n : n) & 0xFF);
  return bytes;
}

}  // namespace

DeflateStream::DeflateStream(NextChunk next, Check check)
    : kind_(check),
      packed_(std::move(next),
              check == Check::kCrc32 ? PackedBlocks::Form::kDeflateCrc : PackedBlocks::Form::kDeflateAdler),
      check_(check == Check::kCrc32 ? 0 : 1) {}

absl::Status DeflateStream::Next(std::string& chunk) {
  constexpr std::string_view kEnd("\x03\0", 2);  // an empty block, the last one
  chunk.clear();
  if (ended_) return absl::OkStatus();
  if (auto status = packed_.Take(blocks_); !status.ok()) return status;
  const auto combine = kind_ == Check::kCrc32 ? crc32_combine : adler32_combine;
  for (const PackedBlock& block : blocks_) {
    chunk += block.bytes;
    size_ += block.size;
    check_ = static_cast<uint32_t>(combine(check_, block.check, static_cast<z_off_t>(block.size)));
  }
  ended_ = blocks_.empty();
  if (ended_) chunk = kEnd;
  return absl::OkStatus();
}

absl::StatusOr<uint64_t> AppendDeflated(NextChunk next, StreamForm form, AtomicFile& file) {
  const bool is_zlib = form == StreamForm::kZlib;
  DeflateStream stream(std::move(next), is_zlib ? Check::kAdler32 : Check::kCrc32);
  std::string chunk(is_zlib ? kZlibHead : kGzipHead);
  uint64_t bytes = 0;
  while (!chunk.empty()) {
    if (auto status = file.Append(chunk); !status.ok()) return status;
    bytes += chunk.size();
    if (auto status = stream.Next(chunk); !status.ok()) {
      return absl::Status(status.code(), absl::StrCat(file.target(), ": ", status.message()));
    }
  }
  chunk = FourBytes(stream.check(), is_zlib);
  if (!is_zlib) chunk += FourBytes(static_cast<uint32_t>(stream.size()), false);
  if (auto status = file.Append(chunk); !status.ok()) return status;
  return bytes + chunk.size();
}

}  // namespace latvox::client
