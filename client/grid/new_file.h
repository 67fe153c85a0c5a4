// A file that is being written, for writers that throw. Internal to latvox::grid and the tool.
#ifndef LATVOX_CLIENT_GRID_NEW_FILE_H_
#define LATVOX_CLIENT_GRID_NEW_FILE_H_

#include <cerrno>
#include <cstring>
#include <exception>
#include <fstream>
#include <new>
#include <ostream>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "client/grid/passing_sink.h"
#include "latvox/cancellation.h"

namespace latvox::client {

// Calls write(stream), which throws where it cannot take everything, or once the call is cancelled. The file replaces
// an existing one; not atomic. Errors: UNKNOWN, with the path and the message of the system or of an exception;
// RESOURCE_EXHAUSTED: memory; CANCELLED.
template <class Write>
absl::Status WriteNewFile(const std::string& path, const Cancellation& cancellation, const Write& write) {
  const auto cannot = [&path](const char* why) {
    return absl::UnknownError(absl::StrCat(path, ": cannot be written (", why, ")"));
  };
  int refusal = 0;  // error of the system
  try {
    std::vector<char> buffer(size_t{1} << 20);
    std::ofstream file;
    file.rdbuf()->pubsetbuf(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    file.exceptions(std::ios::failbit | std::ios::badbit);
    errno = 0;
    file.open(path, std::ios::binary | std::ios::trunc);
    StoppableSink sink(*file.rdbuf(), cancellation, refusal);
    std::ostream stream(&sink);
    stream.exceptions(std::ios::failbit | std::ios::badbit);
    write(stream);
    file.close();
    return absl::OkStatus();
  } catch (const std::ios_base::failure&) {
    if (auto stopped = CheckGoesOn(cancellation); !stopped.ok()) return stopped;
    return cannot(std::strerror(refusal != 0 ? refusal : errno));  // the exception has only the library's message
  } catch (const std::bad_alloc&) {
    return absl::ResourceExhaustedError(absl::StrCat(path, ": not enough memory to write the grid"));
  } catch (const std::exception& error) {
    return cannot(error.what());
  }
}

}  // namespace latvox::client

#endif  // LATVOX_CLIENT_GRID_NEW_FILE_H_
