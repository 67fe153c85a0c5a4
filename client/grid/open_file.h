// Opens .vdb and .nvdb files, without OpenVDB. Internal to latvox::grid.
#ifndef LATVOX_CLIENT_GRID_OPEN_FILE_H_
#define LATVOX_CLIENT_GRID_OPEN_FILE_H_

#include <cstdint>
#include <fstream>
#include <istream>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace latvox::client {

// Opens a regular file. Errors: NOT_FOUND; INVALID_ARGUMENT, with the path.
absl::StatusOr<std::ifstream> OpenGridFile(const std::string& path);

// Returns the first 8 bytes of a file; 0 if it has fewer. The place in `in` is then its begin.
uint64_t ReadMagic(std::istream& in);

// The error of a file whose first bytes are those of no .vdb and no .nvdb, after the path.
inline constexpr char kNoGridFile[] = ": is neither a .vdb nor a .nvdb file, the only ones whose voxels latvox reads";

// Returns INVALID_ARGUMENT, with the path.
absl::Status NoGrid(const std::string& path);

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_OPEN_FILE_H_
