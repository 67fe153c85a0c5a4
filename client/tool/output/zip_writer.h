// Zip archives.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_ZIP_WRITER_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_ZIP_WRITER_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/tool/output/atomic_file.h"
#include "client/tool/output/packed_blocks.h"

namespace latvox::client {

struct ZipMember {
  std::string name;
  uint64_t bytes;  // in all
  NextChunk next;
};

// Writes the members, deflated, with the date 1980-01-01: the same members make the same bytes. Members of 4 GiB and
// more make a Zip64 archive. PackedBlocks are in memory a few at a time. Errors: FAILED_PRECONDITION, with the target
// and the message of the system; CANCELLED. Precondition: nothing has been written to the file.
absl::Status WriteZip(const std::vector<ZipMember>& members, AtomicFile& file);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_ZIP_WRITER_H_
