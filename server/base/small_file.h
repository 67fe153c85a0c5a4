// Files that the operator names, such as tokens and certificates.
#ifndef LATVOX_SERVER_BASE_SMALL_FILE_H_
#define LATVOX_SERVER_BASE_SMALL_FILE_H_

#include <string>

#include "absl/status/statusor.h"

namespace latvox {

struct SmallFile {
  std::string text;
  bool readable_by_all = false;  // by users who neither own it nor belong to its group
};

// Errors: INVALID_ARGUMENT naming the path, if the file cannot be read, is not a regular file, or is larger than 1 MiB.
absl::StatusOr<SmallFile> ReadSmallFile(const std::string& path);

}  // namespace latvox

#endif  // LATVOX_SERVER_BASE_SMALL_FILE_H_
