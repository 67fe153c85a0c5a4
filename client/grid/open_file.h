// Opens .vdb files, without OpenVDB. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_OPEN_FILE_H_
#define LATVOX_CLIENT_GRID_OPEN_FILE_H_

#include <fstream>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace latvox::client {

// Opens a regular file. Errors: NOT_FOUND; INVALID_ARGUMENT, with the path.
absl::StatusOr<std::ifstream> OpenGridFile(const std::string& path);

// Returns INVALID_ARGUMENT, with the path.
absl::Status NoGrid(const std::string& path);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_OPEN_FILE_H_
