// Compressed streams.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_DEFLATER_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_DEFLATER_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/tool/output/atomic_file.h"
#include "client/tool/output/packed_blocks.h"

namespace latvox::client {

enum class Check { kCrc32, kAdler32 };

// A deflate stream without header and checksum, in PackedBlocks. Not thread-safe.
class DeflateStream {
 public:
  DeflateStream(NextChunk next, Check check);

  // Replaces the chunk by the next bytes of the stream; by nothing at the end. Errors: those of PackedBlocks.
  absl::Status Next(std::string& chunk);

  // Return facts about the bytes before compression, as far as the stream has come.
  uint64_t size() const { return size_; }
  uint32_t check() const { return check_; }

 private:
  const Check kind_;
  PackedBlocks packed_;
  std::vector<PackedBlock> blocks_;
  uint64_t size_ = 0;
  uint32_t check_;
  bool ended_ = false;
};

enum class StreamForm { kZlib, kGzip };

// Appends bytes to a file, compressed. Returns how many bytes the file got. Errors: those of AtomicFile::Append and,
// with the target, of PackedBlocks.
absl::StatusOr<uint64_t> AppendDeflated(NextChunk next, StreamForm form, AtomicFile& file);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_DEFLATER_H_
