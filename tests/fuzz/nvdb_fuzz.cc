// Foreign .nvdb files, as far as latvox trusts no byte of them: headers, metadata, codecs, and the leaves of parts.
#include <openvdb/openvdb.h>

#include <cstdint>
#include <cstdlib>
#include <exception>
#include <new>
#include <sstream>
#include <string>

#include "client/grid/nano_codec.h"
#include "client/grid/nano_frame.h"
#include "client/grid/part_frame.h"

namespace latvox::client {
namespace {

// Every input gives a result or an exception of the reader.
template <class Read>
void Try(const std::string& bytes, const Read& read) {
  std::istringstream in(bytes);
  try {
    read(in);
  } catch (const std::bad_alloc&) {
    std::abort();
  } catch (const std::exception&) {
  }
}

void Unpack(std::istream& in) {
  for (const NanoFrameGrid& grid : ReadNanoFrame(in)) {
    if (ReadNanoGrid(in, grid).size() != grid.header.gridSize) std::abort();
  }
}

void Merge(std::istream& in) {
  const PartFrame part = ReadNanoPart(in);
  in.seekg(static_cast<std::streamoff>(part.leaves_at));
  Leaf leaf;
  for (uint64_t n = 0; n < part.leaves; ++n) ReadNanoLeaf(in, leaf);
}

}  // namespace
}  // namespace latvox::client

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  [[maybe_unused]] static const bool ready = (openvdb::initialize(), true);
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  if (size == 0) return 0;
  latvox::client::Try(bytes, latvox::client::Unpack);
  latvox::client::Try(bytes, latvox::client::Merge);
  return 0;
}
