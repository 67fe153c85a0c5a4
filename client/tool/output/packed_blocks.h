// Bytes that several threads compress.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_PACKED_BLOCKS_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_PACKED_BLOCKS_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"

namespace latvox::client {

// Replaces the chunk by the next bytes; by nothing at the end.
using NextChunk = std::function<void(std::string& chunk)>;

struct PackedBlock {
  std::string bytes;   // compressed
  uint64_t size = 0;   // before
  uint32_t check = 0;  // checksum of the bytes before
};

// Cuts bytes into blocks of 1 MiB, and compresses each as fast as zlib can, because most of a dense array is empty. No
// block needs another one. So the threads of oneTBB compress several at a time, and the next bytes are made at the same
// time. The same bytes make the same blocks for any number of threads. Memory: 3 MiB for each thread, at most 48 MiB.
// Not thread-safe.
class PackedBlocks {
 public:
  static constexpr size_t kBlock = size_t{1} << 20;

  enum class Form {
    kZlib,          // whole streams of zlib
    kDeflateCrc,    // pieces of one deflate stream, without its end; checksums are crc32
    kDeflateAdler,  // the same with adler32
  };

  PackedBlocks(NextChunk next, Form form);

  // Replaces the blocks by the next ones; by none at the end. Errors: RESOURCE_EXHAUSTED (memory).
  absl::Status Take(std::vector<PackedBlock>& blocks);

 private:
  void Read();  // makes the bytes of the next blocks

  const NextChunk next_;
  const Form form_;
  const size_t most_;                     // blocks at a time
  std::string chunk_;                     // the last one
  size_t at_ = 0;                         // its bytes in blocks
  std::vector<std::string> now_, later_;  // bytes of blocks
  size_t count_ = 0;                      // blocks in later_
  bool begun_ = false, ended_ = false;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_PACKED_BLOCKS_H_
