// Compressed streams, read from front to back.
#ifndef LATVOX_CLIENT_TOOL_INSPECT_INFLATED_SOURCE_H_
#define LATVOX_CLIENT_TOOL_INSPECT_INFLATED_SOURCE_H_

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "client/tool/inspect/byte_source.h"

namespace latvox::client {

// The content of the rest of a file, which is one stream of gzip or zlib. Memory: 100 KB. Not thread-safe. Errors of
// reading: INVALID_ARGUMENT: damaged, cut short, or bytes behind the stream; RESOURCE_EXHAUSTED (memory).
class InflatedSource final : public ByteSource {
 public:
  // `packed` outlives this.
  InflatedSource(const std::string& name, ByteSource& packed);
  ~InflatedSource() override;

  absl::StatusOr<size_t> ReadSome(char* to, size_t count) override;

 private:
  struct Stream;

  ByteSource& packed_;
  const std::unique_ptr<Stream> stream_;
};

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_INSPECT_INFLATED_SOURCE_H_
