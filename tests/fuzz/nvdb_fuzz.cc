// Foreign .nvdb files, as far as latvox trusts no byte of them: headers, metadata and codecs.
#include <openvdb/openvdb.h>

#include <cstdint>
#include <cstdlib>
#include <exception>
#include <new>
#include <sstream>
#include <string>

#include "client/grid/nano_codec.h"
#include "client/grid/nano_frame.h"

namespace latvox::client {
namespace {

// Every input gives grids or an exception of the reader.
void Unpack(const std::string& bytes) {
  std::istringstream in(bytes);
  try {
    for (const NanoFrameGrid& grid : ReadNanoFrame(in)) {
      if (ReadNanoGrid(in, grid).size() != grid.header.gridSize) std::abort();
    }
  } catch (const std::bad_alloc&) {
    std::abort();
  } catch (const std::exception&) {
  }
}

}  // namespace
}  // namespace latvox::client

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  [[maybe_unused]] static const bool ready = (openvdb::initialize(), true);
  if (size != 0) latvox::client::Unpack(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
