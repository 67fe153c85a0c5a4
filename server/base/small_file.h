// Files that the operator names: tokens, certificates.
#ifndef LATVOX_SERVER_BASE_SMALL_FILE_H_
#define LATVOX_SERVER_BASE_SMALL_FILE_H_

#include <string>

#include "absl/status/statusor.h"

namespace latvox {

struct SmallFile {
  std::string text;
  bool readable_by_all = false;  // by users that neither own it nor are of its group
};

// Errors: INVALID_ARGUMENT naming the path, if it cannot be read, is no regular file, or is larger than 1 MiB.
absl::StatusOr<SmallFile> ReadSmallFile(const std::string& path);

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_SMALL_FILE_H_
