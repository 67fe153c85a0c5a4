// Zip archives.
#ifndef LATVOX_CLIENT_TOOL_OUTPUT_ZIP_WRITER_H_
#define LATVOX_CLIENT_TOOL_OUTPUT_ZIP_WRITER_H_

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/tool/output/atomic_file.h"

namespace latvox::client {

struct ZipMember {
  std::string name;
  uint64_t bytes;                                // in all
  std::function<void(std::string& chunk)> next;  // replaces the chunk by the next bytes; by nothing at the end
};

// Writes the members, deflated, with the date 1980-01-01: the same members make the same bytes. Members of 4 GiB and
// more make a Zip64 archive. The chunks are in memory one at a time. Errors: FAILED_PRECONDITION, with the target and
// the message of the system.
// Precondition: nothing has been written to the file.
absl::Status WriteZip(const std::vector<ZipMember>& members, AtomicFile& file);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_TOOL_OUTPUT_ZIP_WRITER_H_
