#include "client/grid/grid_file.h"

#include <openvdb/io/Archive.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <vector>

#include "absl/strings/str_cat.h"

namespace latvox::client {
namespace {

constexpr size_t kBufferBytes = size_t{1} << 20;

// io::File does not check whether its stream took everything: on a full disk it leaves half a file without an error.
struct Writer : openvdb::io::Archive {
  void Write(const openvdb::GridCPtrVec& grids, std::ostream& out) const { write(out, grids, /*seekable=*/true); }
};

}  // namespace

absl::Status WriteGridFile(const openvdb::GridCPtrVec& grids, const std::string& path) {
  const auto cannot = [&path](const char* why) {
    return absl::UnknownError(absl::StrCat(path, ": cannot be written (", why, ")"));
  };
  try {
    std::vector<char> buffer(kBufferBytes);
    std::ofstream file;
    file.rdbuf()->pubsetbuf(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    errno = 0;
    file.open(path, std::ios::binary | std::ios::trunc);
    file.exceptions(std::ios::failbit | std::ios::badbit);
    Writer().Write(grids, file);
    file.close();
    return absl::OkStatus();
  } catch (const std::ios_base::failure&) {
    return cannot(std::strerror(errno));  // the exception has only the library's message
  } catch (const std::exception& error) {
    return cannot(error.what());
  }
}

}  // namespace latvox::client
