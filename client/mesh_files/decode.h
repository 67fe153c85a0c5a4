// Packed and wide text.
#ifndef LATVOX_CLIENT_MESH_FILES_DECODE_H_
#define LATVOX_CLIENT_MESH_FILES_DECODE_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "latvox/warning.h"

namespace latvox::client {

inline constexpr uint64_t kMostUnpacked = uint64_t{4} << 30;  // bytes

// Unpacks gzip, told by its first bytes. Turns UTF-16 with a byte order mark into UTF-8. Other bytes stay as they are.
// Bytes after the packed ones give the warning TRAILING_DATA. Errors: INVALID_ARGUMENT, damaged or cut short;
// RESOURCE_EXHAUSTED, more than `most` bytes unpacked.
absl::StatusOr<std::string> Decode(std::string bytes, std::vector<Warning>& warnings, uint64_t most = kMostUnpacked);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_MESH_FILES_DECODE_H_
