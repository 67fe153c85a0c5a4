// Compressed streams.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_DEFLATER_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_DEFLATER_H_

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "client/tool/output/atomic_file.h"

namespace latvox::client {

// Appends bytes to a file, compressed as fast as zlib can, because most of a dense array is empty. The same bytes make
// the same file. Memory: 300 KB. Not thread-safe. Errors: those of AtomicFile::Append; RESOURCE_EXHAUSTED (memory).
class Deflater {
 public:
  enum class Form { kZlib, kGzip };

  // `file` outlives this.
  Deflater(AtomicFile& file, Form form);
  ~Deflater();
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;

  absl::Status Append(std::string_view bytes);

  // Ends the stream.
  absl::Status Finish();

  // Returns how many bytes the file got.
  uint64_t bytes() const { return bytes_; }

 private:
  struct Stream;
  absl::Status Run(std::string_view bytes, int flush);

  AtomicFile& file_;
  const std::unique_ptr<Stream> stream_;
  uint64_t bytes_ = 0;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_DEFLATER_H_
