#include "client/grid/nano_file.h"

#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>

#include <cerrno>
#include <cstring>
#include <exception>
#include <fstream>

#include "absl/strings/str_cat.h"

namespace latvox::client {

absl::Status WriteNanoFile(const openvdb::BoolGrid& grid, const std::string& path) {
  const auto cannot = [&path](const char* why) {
    return absl::UnknownError(absl::StrCat(path, ": cannot be written (", why, ")"));
  };
  try {
    const auto handle = nanovdb::openToNanoVDB(grid);
    std::ofstream file;
    // NanoVDB does not look whether its stream took everything.
    file.exceptions(std::ios::failbit | std::ios::badbit);
    errno = 0;
    file.open(path, std::ios::binary | std::ios::trunc);
    nanovdb::io::writeGrid(file, handle);
    file.close();
    return absl::OkStatus();
  } catch (const std::ios_base::failure&) {
    return cannot(std::strerror(errno));
  } catch (const std::exception& error) {
    return cannot(error.what());
  }
}

}  // namespace latvox::client
